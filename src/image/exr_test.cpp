#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <gtest/gtest.h>
#include <half.h>

#include "core/hash.h"
#include "core/vec.h"
#include "files/atomic_file.h"
#include "files/testing/temp_folder.h"
#include "relume/error.h"
#include "relume/image_io.h"

namespace relume {
namespace {

ExrFile make_layered(int width, int height) {
  ExrFile exr;
  exr.width = width;
  exr.height = height;
  uint32_t seed = 0;
  for (const char* name : {"R", "G", "B", "albedo.R", "depth.Z", "motion.X"}) {
    ExrChannel channel{name, std::vector<float>(static_cast<size_t>(width * height))};
    for (float& value : channel.values) value = to_unit_float(hash(++seed)) * 100.0f - 50.0f;
    exr.channels.push_back(channel);
  }
  exr.attributes = {{"relume.settings", "{\"seed\": 7}"}, {"a name that is longer than thirty-one characters", "ü\nb"}};
  return exr;
}

std::vector<uint32_t> bits(const std::vector<float>& values) {
  std::vector<uint32_t> result;
  for (const float value : values) result.push_back(float_bits(value));
  return result;
}

TEST(Exr, RoundTripKeepsEveryBit) {
  const TempFolder folder;
  ExrFile written = make_layered(33, 17);
  constexpr float kInf = std::numeric_limits<float>::infinity();
  const float special[] = {kInf, -kInf, std::nanf(""), -0.0f, 1e-40f, 3e38f};
  std::copy(std::begin(special), std::end(special), written.channels[0].values.begin());
  write_exr(folder / "a.exr", written);
  const ExrFile read = read_exr(folder / "a.exr");
  EXPECT_EQ(read.width, 33);
  EXPECT_EQ(read.height, 17);
  EXPECT_EQ(read.attributes, written.attributes);
  ASSERT_EQ(read.channels.size(), written.channels.size());
  for (const ExrChannel& channel : written.channels) {
    ASSERT_NE(read.find(channel.name), nullptr) << channel.name;
    EXPECT_EQ(bits(read.find(channel.name)->values), bits(channel.values)) << channel.name;
  }
}

TEST(Exr, SameContentsGiveTheSameBytes) {
  const TempFolder folder;
  write_exr(folder / "a.exr", make_layered(40, 40));
  write_exr(folder / "b.exr", make_layered(40, 40));
  EXPECT_EQ(read_file(folder / "a.exr"), read_file(folder / "b.exr"));
}

/// Writes a channel with values 1, 2, 3 … over a data window, like another program.
void write_foreign(const std::filesystem::path& file, const Imath::Box2i& display, const Imath::Box2i& data,
                   Imf::PixelType type, const char* name, Imf::Compression compression, bool tiled) {
  Imf::Header header(display, data);
  header.compression() = compression;
  header.channels().insert(name, Imf::Channel(type));
  const auto width = static_cast<size_t>(int64_t{data.max.x} - data.min.x + 1);
  const auto height = static_cast<size_t>(int64_t{data.max.y} - data.min.y + 1);
  std::vector<uint32_t> uints(width * height);
  std::vector<half> halves(width * height);
  for (size_t i = 0; i < uints.size(); ++i) {
    uints[i] = static_cast<uint32_t>(i + 1);
    halves[i] = static_cast<float>(i + 1);
  }
  Imf::FrameBuffer frame_buffer;
  void* base = type == Imf::HALF ? static_cast<void*>(halves.data()) : uints.data();
  const size_t size = type == Imf::HALF ? sizeof(half) : sizeof(uint32_t);
  frame_buffer.insert(name, Imf::Slice::Make(type, base, data, size, size * width));
  if (tiled) {
    header.setTileDescription(Imf::TileDescription(8, 8, Imf::MIPMAP_LEVELS));
    Imf::TiledOutputFile out(file.string().c_str(), header);
    out.setFrameBuffer(frame_buffer);
    out.writeTiles(0, out.numXTiles() - 1, 0, out.numYTiles() - 1);
    // Coarser levels: any values, because the reader uses the finest level.
    for (int level = 1; level < out.numLevels(); ++level)
      out.writeTiles(0, out.numXTiles(level) - 1, 0, out.numYTiles(level) - 1, level);
  } else {
    Imf::OutputFile out(file.string().c_str(), header);
    out.setFrameBuffer(frame_buffer);
    out.writePixels(static_cast<int>(height));
  }
}

TEST(Exr, ReadsOtherTypesCompressionsAndTiles) {
  const TempFolder folder;
  const Imath::Box2i window({0, 0}, {19, 11});
  for (const Imf::PixelType type : {Imf::HALF, Imf::UINT}) {
    for (const Imf::Compression compression :
         {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::PIZ_COMPRESSION}) {
      for (const bool tiled : {false, true}) {
        write_foreign(folder / "a.exr", window, window, type, "Y", compression, tiled);
        const Image image = read_image(folder / "a.exr");
        ASSERT_EQ(image.width, 20);
        ASSERT_EQ(image.height, 12);
        for (size_t i = 0; i < image.pixels.size(); ++i) ASSERT_EQ(image.pixels[i], Rgb(static_cast<float>(i + 1)));
      }
    }
  }
}

TEST(Exr, DataWindowIsPlacedInTheDisplayWindow) {
  const TempFolder folder;
  // Display 4x3 from (10, 20); data 3x3 from (12, 19) exceeds it by one column on the right and one row at the top.
  write_foreign(folder / "a.exr", {{10, 20}, {13, 22}}, {{12, 19}, {14, 21}}, Imf::UINT, "Y", Imf::ZIP_COMPRESSION,
                false);
  const ExrFile exr = read_exr(folder / "a.exr");
  EXPECT_EQ(exr.width, 4);
  EXPECT_EQ(exr.height, 3);
  EXPECT_EQ(exr.channels.at(0).values, (std::vector<float>{0, 0, 4, 5, 0, 0, 7, 8, 0, 0, 0, 0}));
}

TEST(Exr, WritesTheDataWindowAlone) {
  const TempFolder folder;
  ExrFile exr{4, 3, {{"Y", {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}}}, {}, {.x = 1, .y = 1, .width = 2, .height = 2}};
  write_exr(folder / "a.exr", exr);
  const ExrFile read = read_exr(folder / "a.exr");
  EXPECT_EQ(read.width, 4);
  EXPECT_EQ(read.height, 3);
  EXPECT_EQ(read.channels.at(0).values, (std::vector<float>{0, 0, 0, 0, 0, 6, 7, 0, 0, 10, 11, 0}));
  EXPECT_EQ(read.data_window, exr.data_window);
  exr.data_window.x = 3;
  EXPECT_THROW(write_exr(folder / "a.exr", exr), Error);
}

TEST(Exr, SubsampledChromaBecomesRgb) {
  const TempFolder folder;
  Imf::Header header(4, 2);
  header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
  header.channels().insert("RY", Imf::Channel(Imf::FLOAT, 2, 2));
  header.channels().insert("BY", Imf::Channel(Imf::FLOAT, 2, 2));
  const Imath::Box2i window = header.dataWindow();
  const Rgb color(0.8f, 0.4f, 0.2f);
  const float y = luminance(color);
  std::vector<float> ys(8, y);
  std::vector<float> rys(2, color.r / y - 1.0f);
  std::vector<float> bys(2, color.b / y - 1.0f);
  Imf::FrameBuffer frame_buffer;
  frame_buffer.insert("Y", Imf::Slice::Make(Imf::FLOAT, ys.data(), window, 4, 16));
  frame_buffer.insert("RY", Imf::Slice::Make(Imf::FLOAT, rys.data(), window, 4, 8, 2, 2));
  frame_buffer.insert("BY", Imf::Slice::Make(Imf::FLOAT, bys.data(), window, 4, 8, 2, 2));
  {
    Imf::OutputFile out((folder / "a.exr").string().c_str(), header);
    out.setFrameBuffer(frame_buffer);
    out.writePixels(2);
  }
  const Image image = read_image(folder / "a.exr");
  for (const Rgb& pixel : image.pixels) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel[c], color[c], 1e-6f);  // a few roundings
  }
}

TEST(Exr, FindsLayersAndNamesMissingChannels) {
  ExrFile exr;
  exr.width = exr.height = 1;
  for (const char* name : {"view.B", "view.G", "view.R", "z.Z"})
    exr.channels.push_back({name, {static_cast<float>(std::string_view(name).back())}});
  EXPECT_EQ(image_from_exr(exr, "", "x").at(0, 0), Rgb('R', 'G', 'B'));
  EXPECT_EQ(image_from_exr(exr, "view", "x").at(0, 0), Rgb('R', 'G', 'B'));
  try {
    image_from_exr(exr, "albedo", "x.exr");
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("x.exr: no channels albedo.R"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("z.Z"), std::string::npos) << e.what();
  }
}

TEST(Exr, RefusesInconsistentChannels) {
  const TempFolder folder;
  ExrFile wrong_size = make_layered(4, 4);
  wrong_size.channels[2].values.pop_back();
  EXPECT_THROW(write_exr(folder / "a.exr", wrong_size), Error);
  ExrFile twice = make_layered(4, 4);
  twice.channels[1].name = "R";
  EXPECT_THROW(write_exr(folder / "a.exr", twice), Error);
  ExrFile reserved = make_layered(4, 4);
  reserved.attributes["dataWindow"] = "no";
  EXPECT_THROW(write_exr(folder / "a.exr", reserved), Error);
  EXPECT_THROW(write_exr(folder / "a.exr", ExrFile{}), Error);
  EXPECT_EQ(folder.file_count(), 0u);
}

std::vector<std::byte> small_file() {
  const TempFolder folder;
  write_exr(folder / "a.exr", make_layered(20, 20));
  return read_file(folder / "a.exr");
}

TEST(ExrMalformed, EveryTruncationIsAnError) {
  const auto bytes = small_file();
  for (size_t size = 0; size < bytes.size(); size += size < 1200 ? 1 : 97)
    EXPECT_THROW(parse_exr({bytes.data(), size}, "truncated"), Error) << size;
}

TEST(ExrMalformed, FlippedBitsNeverCrash) {
  const auto original = small_file();
  int errors = 0;
  for (uint32_t i = 0; i < 1500; ++i) {
    auto bytes = original;
    // Half of the flips are in the header, where they do most harm.
    const size_t range = i % 2 == 0 ? 800 : bytes.size();
    bytes[hash(i) % range] ^= static_cast<std::byte>(1u << (hash(i, 1) & 7u));
    try {
      parse_exr(bytes, "flipped");
    } catch (const Error&) {
      ++errors;
    }
  }
  EXPECT_GT(errors, 100);  // flips in pixels often pass: every bit pattern is a float
}

void overwrite_window(std::vector<std::byte>& bytes, const char* attribute, const std::array<int32_t, 4>& window) {
  const std::string key = std::string(attribute) + '\0' + "box2i" + '\0';
  const auto* begin = reinterpret_cast<const char*>(bytes.data());
  const size_t at = std::string_view(begin, bytes.size()).find(key);
  ASSERT_NE(at, std::string_view::npos);
  std::memcpy(bytes.data() + at + key.size() + 4, window.data(), sizeof(window));
}

TEST(ExrMalformed, AbsurdSizesAreRefusedBeforeAllocation) {
  constexpr int32_t kMax = std::numeric_limits<int32_t>::max();
  const std::array<int32_t, 4> windows[] = {{0, 0, 31622, 31622},  // 10^9 pixels
                                            {0, 0, 999999999, 0},    {0, 0, 0, 999999999}, {0, 0, 16000, 16000},
                                            {-kMax - 1, 0, kMax, 1}, {5, 5, 4, 4},         {0, 0, 100000, 0}};
  for (const auto& window : windows) {
    auto data = small_file();
    overwrite_window(data, "dataWindow", window);
    EXPECT_THROW(parse_exr(data, "data"), Error) << window[2] << ' ' << window[3];
    auto display = small_file();
    overwrite_window(display, "displayWindow", window);
    if (window[2] > 100000 || window[2] < window[0] || window[2] == 31622) {
      EXPECT_THROW(parse_exr(display, "display"), Error) << window[2] << ' ' << window[3];
    }
  }
}

TEST(ExrMalformed, DeepFilesAreRefusedWithAReason) {
  auto bytes = small_file();
  bytes[5] |= std::byte{0x08};
  try {
    parse_exr(bytes, "deep.exr");
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("deep"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace relume
