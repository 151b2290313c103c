#include "parts/sums_file.h"

#include <cstring>
#include <vector>

#include <gtest/gtest.h>

#include "files/testing/temp_folder.h"
#include "relume/error.h"
#include "relume/merge.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

MergedSums image_of_8x4() {
  AllSettings settings;
  settings.render.width = 8;
  settings.render.height = 4;
  MergedSums merged{8, 4, {2, 1, 4, 2}, {}, {}};
  merged.attributes = {{"relume.version", "1"},
                       {"relume.scene_hash", "a"},
                       {"relume.crop", "2,1,4,2"},
                       {"relume.settings", settings_to_json(describe(settings))}};
  merged.samples = SampleRanges({0, 15});
  merged.samples.add(SampleRanges({32, 47}));
  return merged;
}

/// Sums in the window, and zeros elsewhere.
std::vector<PixelSums> some_sums() {
  std::vector<PixelSums> sums(32);
  for (size_t y = 1; y < 3; ++y) {
    for (size_t x = 2; x < 6; ++x) {
      PixelSums& pixel = sums[8 * y + x];
      pixel.radiance.r.add(static_cast<double>(x) * 0.3);
      pixel.radiance.square.add(static_cast<double>(y));
      pixel.rays = static_cast<uint32_t>(10 * x + y);
    }
  }
  return sums;
}

TEST(SumsFile, KeepsAllBits) {
  const TempFolder folder;
  const auto file = folder / "out.ckpt";
  const std::vector<PixelSums> sums = some_sums();
  write_sums_file(file, image_of_8x4(), sums);
  EXPECT_TRUE(is_sums_file(file));
  std::vector<PixelSums> read(sums.size());
  MergedSums expected = image_of_8x4();
  expected.samples = {};
  const PartInfo info = read_sums_file(file, expected, read);
  EXPECT_EQ(info.samples.to_string(), "0-15,32-47");
  EXPECT_EQ(std::memcmp(read.data(), sums.data(), sums.size() * sizeof(PixelSums)), 0);
}

TEST(SumsFile, IsAPart) {
  const TempFolder folder;
  write_sums_file(folder / "out.ckpt", image_of_8x4(), some_sums());
  const MergeReport report = merge_images({folder / "out.ckpt"}, folder / "out.exr");
  EXPECT_EQ(report.samples, 32u);
  EXPECT_EQ(report.missing, 16u);
}

TEST(SumsFile, BelongsToOneImage) {
  const TempFolder folder;
  const auto file = folder / "out.ckpt";
  write_sums_file(file, image_of_8x4(), some_sums());
  std::vector<PixelSums> read(32);
  MergedSums other = image_of_8x4();
  other.attributes["relume.scene_hash"] = "b";
  EXPECT_THROW(read_sums_file(file, other, read), Error);
  other = image_of_8x4();
  other.surface = true;
  EXPECT_THROW(read_sums_file(file, other, read), Error);
  EXPECT_EQ(read.front().rays, 0u);
}

}  // namespace
}  // namespace relume
