#include "image/ktx2/uastc.h"

#include <algorithm>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "image/ktx2/testing/uastc_block.h"

namespace relume::detail {
namespace {

using relume::testing::astc_partition;
using relume::testing::astc_texels;
using relume::testing::uastc_endpoint_layout;
using relume::testing::uastc_patterns;
using relume::testing::uastc_planes;
using relume::testing::uastc_weight_bits;
using relume::testing::UastcBlock;
using relume::testing::UastcEndpointLayout;
using relume::testing::write_uastc_block;

constexpr UastcTexels::value_type kMagenta = {255, 0, 255, 255};

UastcTexels decode(const std::vector<std::byte>& bytes, bool srgb = false) {
  return decode_uastc_block(std::span<const std::byte, kUastcBlockBytes>(bytes.data(), bytes.size()), srgb);
}

uint32_t below(uint32_t end, std::mt19937& random) { return static_cast<uint32_t>(random() % end); }

/// A block of `mode` with random endpoints, weights and hints.
UastcBlock random_block(int mode, uint32_t pattern, std::mt19937& random) {
  UastcBlock block;
  block.mode = mode;
  block.pattern = pattern;
  block.selector = below(4, random);
  block.hints = static_cast<uint32_t>(random());
  for (uint8_t& channel : block.solid) channel = static_cast<uint8_t>(random());
  const UastcEndpointLayout layout = mode == 8 ? UastcEndpointLayout{} : uastc_endpoint_layout(mode);
  for (size_t i = 0; i < layout.count; ++i)
    block.endpoints.push_back({below(layout.base, random), below(1u << layout.bits, random)});
  const uint32_t levels = 1u << uastc_weight_bits(mode);
  std::set<int> anchored;
  const std::array<int, 16> partition = astc_partition(mode, pattern);
  for (size_t i = 0; i < 16; ++i) {
    const uint32_t anchor_levels = anchored.insert(partition[i]).second ? levels / 2 : levels;
    for (uint32_t& weight : block.weights[i]) weight = below(std::max(anchor_levels, 1u), random);
  }
  return block;
}

class UastcModes : public ::testing::TestWithParam<int> {};
class UastcModesWithEndpoints : public UastcModes {};

TEST_P(UastcModes, TexelsAreThoseOfAstc) {
  const int mode = GetParam();
  std::mt19937 random(static_cast<uint32_t>(mode));
  const uint32_t patterns = std::max(uastc_patterns(mode), 1u);
  for (uint32_t i = 0; i < 20 * patterns; ++i) {
    const UastcBlock block = random_block(mode, i % patterns, random);
    const std::vector<std::byte> bytes = write_uastc_block(block);
    ASSERT_EQ(bytes.size(), kUastcBlockBytes);
    for (const bool srgb : {false, true})
      ASSERT_EQ(decode(bytes, srgb), astc_texels(block, srgb)) << "block " << i << ", sRGB " << srgb;
  }
}

/// Tests every endpoint value, at weight 0.
TEST_P(UastcModesWithEndpoints, EveryEndpointValueIsUnquantised) {
  const int mode = GetParam();
  const UastcEndpointLayout layout = uastc_endpoint_layout(mode);
  UastcBlock block;
  block.mode = mode;
  block.endpoints.resize(layout.count);
  for (uint32_t digit = 0; digit < layout.base; ++digit) {
    for (uint32_t bits = 0; bits < 1u << layout.bits; ++bits) {
      for (UastcBlock::Value& value : block.endpoints) value = {digit, bits};
      ASSERT_EQ(decode(write_uastc_block(block)), astc_texels(block, false)) << digit << ", " << bits;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, UastcModes, ::testing::Range(0, 19));
INSTANTIATE_TEST_SUITE_P(BeforeSolid, UastcModesWithEndpoints, ::testing::Range(0, 8));
INSTANTIATE_TEST_SUITE_P(AfterSolid, UastcModesWithEndpoints, ::testing::Range(9, 19));

TEST(Uastc, InterpolatesBetweenEndpoints) {
  UastcBlock block;
  block.mode = 1;  // 8 bits per channel, 2 bits per weight
  block.endpoints = {{0, 10}, {0, 250}, {0, 0}, {0, 255}, {0, 100}, {0, 100}};
  block.weights[1][0] = 1;
  block.weights[2][0] = 2;
  block.weights[3][0] = 3;
  const UastcTexels texels = decode(write_uastc_block(block));
  EXPECT_EQ(texels[0], (UastcTexels::value_type{10, 0, 100, 255}));
  EXPECT_EQ(texels[1], (UastcTexels::value_type{89, 84, 100, 255}));
  EXPECT_EQ(texels[2], (UastcTexels::value_type{171, 171, 100, 255}));
  EXPECT_EQ(texels[3], (UastcTexels::value_type{250, 255, 100, 255}));
}

TEST(Uastc, SecondPlaneMovesOneChannel) {
  UastcBlock block;
  block.mode = 13;  // RGBA, 8 bits per channel, 1 bit per weight
  block.endpoints = {{0, 1}, {0, 201}, {0, 2}, {0, 202}, {0, 3}, {0, 203}, {0, 4}, {0, 204}};
  block.weights[5] = {0, 1};
  for (uint32_t channel = 0; channel < 4; ++channel) {
    block.selector = channel;
    UastcTexels::value_type expected = {1, 2, 3, 4};
    expected[channel] = static_cast<uint8_t>(expected[channel] + 200);
    EXPECT_EQ(decode(write_uastc_block(block))[5], expected) << channel;
  }
}

TEST(Uastc, InvalidBlocksAreMagenta) {
  std::vector<std::byte> bytes(kUastcBlockBytes);
  bytes[0] = std::byte{0x45};  // the reserved mode
  EXPECT_EQ(decode(bytes)[7], kMagenta);
  UastcBlock block;
  for (const int mode : {2, 3, 4, 7, 9, 16}) {
    block.mode = mode;
    block.endpoints.assign(uastc_endpoint_layout(mode).count, {});
    bytes = write_uastc_block(block);
    // The pattern ends before the endpoints, which are 0. 31 and 15 are invalid patterns in all modes.
    const size_t first = mode == 9 ? 5 + 23 : mode == 16 ? 6 + 23 : 5 + 15;
    for (size_t bit = first; bit < first + (mode == 3 ? 4u : 5u); ++bit)
      bytes[bit / 8] |= static_cast<std::byte>(1u << (bit % 8));
    EXPECT_EQ(decode(bytes)[0], kMagenta) << mode;
  }
}

TEST(Uastc, BlocksOfAnyBitsDecode) {
  std::mt19937 random(3);
  std::vector<std::byte> bytes(kUastcBlockBytes);
  size_t opaque = 0;
  for (int i = 0; i < 20000; ++i) {
    for (std::byte& byte : bytes) byte = static_cast<std::byte>(random());
    opaque += decode(bytes, i % 2 == 0)[0][3] == 255 ? 1u : 0u;
  }
  EXPECT_GT(opaque, 1000u);
}

/// 6 × 5 texels need 2 × 2 blocks; the right and bottom ones are cropped.
TEST(Uastc, ImagesCutTheirLastBlocks) {
  std::vector<std::byte> blocks;
  for (uint8_t i = 0; i < 4; ++i) {
    UastcBlock block;
    block.mode = 8;
    block.solid = {i, 10, 20, 30};
    const std::vector<std::byte> bytes = write_uastc_block(block);
    blocks.insert(blocks.end(), bytes.begin(), bytes.end());
  }
  const std::vector<uint8_t> rgba = decode_uastc(blocks, 6, 5, false);
  ASSERT_EQ(rgba.size(), size_t{4} * 6 * 5);
  for (size_t y = 0; y < 5; ++y) {
    for (size_t x = 0; x < 6; ++x) {
      EXPECT_EQ(rgba[4 * (y * 6 + x)], (y < 4 ? 0 : 2) + (x < 4 ? 0 : 1)) << x << ", " << y;
      EXPECT_EQ(rgba[4 * (y * 6 + x) + 3], 30);
    }
  }
}

}  // namespace
}  // namespace relume::detail
