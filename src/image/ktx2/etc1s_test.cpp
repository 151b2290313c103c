#include "image/ktx2/etc1s.h"

#include <algorithm>
#include <array>
#include <random>

#include <gtest/gtest.h>

#include "image/ktx2/testing/etc1s_writer.h"
#include "image/ktx2/testing/huffman_writer.h"
#include "relume/error.h"
#include "scene/testing/plate.h"

namespace relume::detail {
namespace {

using relume::testing::BitWriter;
using relume::testing::Etc1sBlocks;
using relume::testing::Etc1sCodebooks;
using relume::testing::Etc1sStatistics;
using relume::testing::Etc1sStreams;
using relume::testing::HuffmanWriter;
using relume::testing::problem_of;
using relume::testing::write_etc1s;
using relume::testing::write_etc1s_endpoints;
using relume::testing::write_etc1s_selectors;

const std::string kName = "a.ktx2";

uint32_t below(uint32_t end, std::mt19937& random) { return static_cast<uint32_t>(random() % end); }

Etc1sCodebooks random_codebooks(uint32_t endpoints, uint32_t selectors, std::mt19937& random) {
  Etc1sCodebooks codebooks;
  for (uint32_t i = 0; i < endpoints; ++i) {
    Etc1sEndpoint endpoint;
    for (uint8_t& channel : endpoint.color) channel = static_cast<uint8_t>(below(32, random));
    endpoint.intensity = static_cast<uint8_t>(below(8, random));
    codebooks.endpoints.push_back(endpoint);
  }
  for (uint32_t i = 0; i < selectors; ++i) {
    Etc1sSelector selector;
    for (uint8_t& row : selector) row = static_cast<uint8_t>(below(256, random));
    codebooks.selectors.push_back(selector);
  }
  return codebooks;
}

/// Random blocks that often repeat their neighbours.
Etc1sBlocks random_blocks(size_t width, size_t height, const Etc1sCodebooks& codebooks, std::mt19937& random) {
  Etc1sBlocks blocks{width, height, {}, {}};
  for (size_t i = 0; i < width * height; ++i) {
    const bool repeat_endpoint = i > 0 && below(3, random) > 0;
    const bool repeat_selector = i > 0 && below(3, random) > 0;
    const auto new_endpoint = below(static_cast<uint32_t>(codebooks.endpoints.size()), random);
    const auto new_selector = below(static_cast<uint32_t>(codebooks.selectors.size()), random);
    blocks.endpoints.push_back(repeat_endpoint ? blocks.endpoints.back() : new_endpoint);
    blocks.selectors.push_back(repeat_selector ? blocks.selectors.back() : new_selector);
  }
  return blocks;
}

Etc1sGlobalData read_global_data(const Etc1sStreams& streams, const Etc1sCodebooks& codebooks) {
  return {read_etc1s_endpoints(streams.endpoints, codebooks.endpoints.size(), kName),
          read_etc1s_selectors(streams.selectors, codebooks.selectors.size(), kName),
          read_etc1s_tables(streams.tables, kName)};
}

/// RGB of a texel by the ETC1 rules: a base colour plus −b, −a, a or b.
std::array<uint8_t, 3> expected_texel(const Etc1sCodebooks& codebooks, const Etc1sBlocks& blocks, size_t x, size_t y) {
  constexpr int kSmall[] = {2, 5, 9, 13, 18, 24, 33, 47};
  constexpr int kLarge[] = {8, 17, 29, 42, 60, 80, 106, 183};
  const size_t block = y / 4 * blocks.width + x / 4;
  const Etc1sEndpoint& endpoint = codebooks.endpoints[blocks.endpoints[block]];
  const int selector = codebooks.selectors[blocks.selectors[block]][y % 4] >> (2 * (x % 4)) & 3;
  const int distance = selector == 0 || selector == 3 ? kLarge[endpoint.intensity] : kSmall[endpoint.intensity];
  std::array<uint8_t, 3> texel;
  for (size_t c = 0; c < 3; ++c) {
    const int base = endpoint.color[c] * 8 + endpoint.color[c] / 4;
    texel[c] = static_cast<uint8_t>(std::min(std::max(base + (selector < 2 ? -distance : distance), 0), 255));
  }
  return texel;
}

/// Writes and decodes `blocks`, then compares all texels.
Etc1sStatistics check_round_trip(const Etc1sCodebooks& codebooks, const Etc1sBlocks& blocks, size_t width,
                                 size_t height) {
  const Etc1sStreams streams = write_etc1s(codebooks, {blocks});
  const Etc1sGlobalData global = read_global_data(streams, codebooks);
  const std::vector<uint8_t> rgb = decode_etc1s_slice(streams.slices[0], width, height, global, kName);
  EXPECT_EQ(rgb.size(), 3 * width * height);
  size_t wrong = 0;
  for (size_t y = 0; y < height; ++y) {
    for (size_t x = 0; x < width; ++x) {
      const std::array<uint8_t, 3> expected = expected_texel(codebooks, blocks, x, y);
      if (!std::equal(expected.begin(), expected.end(), &rgb[3 * (y * width + x)])) ++wrong;
    }
  }
  EXPECT_EQ(wrong, 0u) << width << " x " << height;
  return streams.statistics;
}

TEST(Huffman, ReadsCodesOfAnyShape) {
  std::mt19937 random(1);
  for (const uint32_t alphabet : {1u, 2u, 3u, 20u, 300u, 5000u}) {
    HuffmanWriter writer;
    std::vector<uint32_t> symbols;
    for (int i = 0; i < 3000; ++i) {
      // Few symbols are frequent, many have no code, and code lengths form runs.
      const uint32_t symbol = below(alphabet, random) / (1 + below(40, random)) / 7 * 7 % alphabet;
      symbols.push_back(symbol);
      writer.count(symbol);
    }
    BitWriter bits;
    writer.write_table(bits);
    for (const uint32_t symbol : symbols) writer.write(symbol, bits);
    BitReader reader(bits.bytes(), kName);
    const HuffmanTable table = HuffmanTable::read(reader);
    for (const uint32_t symbol : symbols) ASSERT_EQ(table.decode(reader), symbol) << alphabet;
  }
}

TEST(Huffman, RejectsInvalidPrefixCodes) {
  const BitReader reader({}, kName);
  const auto problem = [&](const std::vector<uint8_t>& lengths) {
    return problem_of([&] { HuffmanTable(lengths, reader); });
  };
  const std::string expected = "a.ktx2: damaged image (a Huffman table is not a prefix code); export or copy it again";
  EXPECT_EQ(problem({1, 1, 1}), expected) << "too many codes";
  EXPECT_EQ(problem({2, 2, 2}), expected) << "too few codes";
  EXPECT_EQ(problem({0, 0}), expected) << "no codes";
  EXPECT_EQ(problem({1, 2, 2}), "");
  EXPECT_EQ(problem({0, 1}), "") << "a single code";
}

TEST(Huffman, RefusesDamagedTables) {
  const auto problem = [](const std::vector<std::pair<uint64_t, size_t>>& fields) {
    BitWriter bits;
    for (const auto& [value, count] : fields) bits.put(value, count);
    return problem_of([&] {
      BitReader reader(bits.bytes(), kName);
      HuffmanTable::read(reader).decode(reader);
    });
  };
  EXPECT_NE(problem({{5, 14}, {0, 5}}).find("wrong number of code lengths"), std::string::npos);
  EXPECT_NE(problem({{5, 14}, {22, 5}}).find("wrong number of code lengths"), std::string::npos);
  // Only symbol 17, a run of 3 to 10 zeros, has a code: "0".
  EXPECT_NE(problem({{5, 14}, {1, 5}, {1, 3}, {0, 1}, {7, 3}}).find("too many symbols"), std::string::npos);
  EXPECT_NE(problem({{5, 14}, {1, 5}, {1, 3}, {1, 1}}).find("unknown Huffman code"), std::string::npos);
  // Only symbol 19, a run that repeats a length, has a code.
  EXPECT_NE(problem({{5, 14}, {3, 5}, {0, 6}, {1, 3}, {0, 1}}).find("repeats a length of 0"), std::string::npos);
  EXPECT_NE(problem({{5, 14}, {1, 5}, {1, 3}}).find("cut off"), std::string::npos);
  EXPECT_NE(problem({{0, 14}, {0, 10}}).find("unknown Huffman code"), std::string::npos) << "an empty table";
}

TEST(Etc1s, ReadsEndpoints) {
  std::mt19937 random(2);
  for (const bool grey : {false, true}) {
    Etc1sCodebooks codebooks = random_codebooks(500, 1, random);
    for (Etc1sEndpoint& endpoint : codebooks.endpoints) {
      if (grey) endpoint.color[1] = endpoint.color[2] = endpoint.color[0];
    }
    const auto endpoints = read_etc1s_endpoints(write_etc1s_endpoints(codebooks.endpoints, grey), 500, kName);
    ASSERT_EQ(endpoints.size(), 500u);
    for (size_t i = 0; i < endpoints.size(); ++i) {
      EXPECT_EQ(endpoints[i].color, codebooks.endpoints[i].color) << i;
      EXPECT_EQ(endpoints[i].intensity, codebooks.endpoints[i].intensity) << i;
    }
  }
}

TEST(Etc1s, ReadsSelectors) {
  std::mt19937 random(3);
  for (const uint32_t count : {1u, 2u, 300u}) {
    const Etc1sCodebooks codebooks = random_codebooks(1, count, random);
    for (const bool raw : {false, true})
      EXPECT_EQ(read_etc1s_selectors(write_etc1s_selectors(codebooks.selectors, raw), count, kName),
                codebooks.selectors);
  }
  const std::vector<std::byte> reserved = {std::byte{1}, std::byte{0}};
  EXPECT_NE(problem_of([&] { read_etc1s_selectors(reserved, 1, kName); }).find("unknown encoding"), std::string::npos);
}

TEST(Etc1s, TexelsAreExact) {
  std::mt19937 random(4);
  Etc1sStatistics total;
  for (const size_t history : {0u, 1u, 2u, 3u, 8u, 64u}) {
    for (const auto& [width, height] :
         std::vector<std::pair<size_t, size_t>>{{1, 1}, {4, 4}, {5, 3}, {37, 61}, {128, 90}}) {
      Etc1sCodebooks codebooks = random_codebooks(1 + below(20, random), 1 + below(40, random), random);
      codebooks.history_size = history;
      codebooks.raw_selectors = below(2, random) == 0;
      const Etc1sBlocks blocks = random_blocks((width + 3) / 4, (height + 3) / 4, codebooks, random);
      const Etc1sStatistics statistics = check_round_trip(codebooks, blocks, width, height);
      for (size_t i = 0; i < 4; ++i) total.predictions[i] += statistics.predictions[i];
      total.new_selectors += statistics.new_selectors;
      total.old_selectors += statistics.old_selectors;
      total.selector_runs += statistics.selector_runs;
    }
  }
  for (const size_t count : total.predictions) EXPECT_GT(count, 30u);
  EXPECT_GT(total.new_selectors, 100u);
  EXPECT_GT(total.old_selectors, 100u);
  EXPECT_GT(total.selector_runs, 10u);
}

TEST(Etc1s, RunsHaveAnyLength) {
  std::mt19937 random(5);
  const Etc1sCodebooks codebooks = random_codebooks(3, 3, random);
  for (const size_t side : {3u, 8u, 9u, 60u, 200u}) {
    Etc1sBlocks blocks{side, side, std::vector<uint32_t>(side * side, 1), std::vector<uint32_t>(side * side, 0)};
    blocks.endpoints.back() = 2;
    blocks.selectors.back() = 2;
    const Etc1sStatistics statistics = check_round_trip(codebooks, blocks, 4 * side, 4 * side);
    EXPECT_GT(statistics.selector_runs, 0u);
    if (side >= 60) {
      EXPECT_GT(statistics.prediction_runs, 0u);
      EXPECT_GT(statistics.long_selector_runs, 0u);
    }
  }
}

/// A code with `symbol` as its only symbol.
HuffmanTable only(size_t symbol) {
  std::vector<uint8_t> lengths(symbol + 1);
  lengths[symbol] = 1;
  return HuffmanTable(lengths, BitReader({}, kName));
}

/// Error message from decoding zeros with tables of a single symbol each.
std::string problem_with(size_t prediction, size_t delta, size_t selector, size_t width, size_t history = 2) {
  const Etc1sGlobalData global{std::vector<Etc1sEndpoint>(2),
                               std::vector<Etc1sSelector>(2),
                               {only(prediction), only(delta), only(selector), only(0), history}};
  const std::vector<std::byte> zeros(64);
  return problem_of([&] { decode_etc1s_slice(zeros, width, 8, global, kName); });
}

TEST(Etc1s, RefusesReferencesToNothing) {
  constexpr size_t kDifferences = 0xff;
  EXPECT_EQ(problem_with(kDifferences, 1, 0, 8), "");
  EXPECT_NE(problem_with(0, 0, 0, 8).find("a block outside the image"), std::string::npos) << "to the left";
  EXPECT_NE(problem_with(1, 0, 0, 8).find("a block outside the image"), std::string::npos) << "above";
  EXPECT_NE(problem_with(2, 0, 0, 8).find("a block outside the image"), std::string::npos) << "above left";
  EXPECT_NE(problem_with(257, 0, 0, 8).find("unknown prediction"), std::string::npos);
  EXPECT_NE(problem_with(kDifferences, 4, 0, 8).find("an endpoint that does not exist"), std::string::npos);
  EXPECT_EQ(problem_with(kDifferences, 0, 3, 8), "") << "the last selector of the history";
  EXPECT_EQ(problem_with(kDifferences, 0, 4, 8), "") << "a run";
  EXPECT_NE(problem_with(kDifferences, 0, 5, 8).find("a selector that does not exist"), std::string::npos);
  EXPECT_NE(problem_with(kDifferences, 0, 2, 8, 0).find("a selector that does not exist"), std::string::npos)
      << "no history";
  EXPECT_NE(problem_with(kDifferences, 0, 0, 4000).find("cut off"), std::string::npos);
}

TEST(Etc1s, RefusesRunsWithoutEnd) {
  const Etc1sGlobalData global{
      std::vector<Etc1sEndpoint>(1), std::vector<Etc1sSelector>(1), {only(256), only(0), only(0), only(0), 1}};
  std::vector<std::byte> ones(16, std::byte{0xff});
  ones[0] = std::byte{0xfe};  // a run of predictions with a length above 32 bits
  EXPECT_NE(problem_of([&] { decode_etc1s_slice(ones, 8, 8, global, kName); }).find("has no end"), std::string::npos);
}

TEST(Etc1s, RefusesEmptyCodebooks) {
  const Etc1sTables tables{only(255), only(0), only(0), only(0), 1};
  const std::vector<std::byte> zeros(16);
  const Etc1sGlobalData no_endpoints{{}, std::vector<Etc1sSelector>(1), tables};
  const Etc1sGlobalData no_selectors{std::vector<Etc1sEndpoint>(1), {}, tables};
  for (const Etc1sGlobalData& global : {no_endpoints, no_selectors})
    EXPECT_THROW(decode_etc1s_slice(zeros, 4, 4, global, kName), Error);
}

}  // namespace
}  // namespace relume::detail
