// Tests that ten scenes, written by hand in pbrt, Mitsuba XML and glTF, give the same image in all three formats.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "files/bytes.h"
#include "relume/scene_io.h"
#include "scene_io/pbrt/pbrt_loader.h"
#include "support/image_test.h"
#include "support/measure.h"

namespace relume::support {
namespace {

const std::filesystem::path kFolder = RELUME_SOURCE_DIR "/tests/scene_formats/scenes";
constexpr std::array kFormats = {"pbrt", "xml", "gltf"};
constexpr int kImages = 16;
constexpr int kSeedsPerFormat = 1000;

/// A scene with the samples per pixel of an image. The last numbers are the relative errors that the comparison must
/// detect, per block and in the image's mean (ImageTest::detectable).
struct Case {
  const char* name;
  int spp;
  double blocks = 0.01;
  double mean = 0.005;
};

constexpr std::array kCases = {
    Case{"letters", 8}, Case{"lamps", 16}, Case{"spots", 16, 0.03, 0.01},
    Case{"sun", 16},    Case{"glass", 16}, Case{"skylight", 16},
    Case{"cutout", 16}, Case{"pane", 16},  Case{"metal", 16},
    Case{"lens", 16},
};

/// Relative error of a block by interpolation between the pixels of environment maps: pbrt's map of equal areas has
/// others than the equirectangular one. Single pixels deviate by up to 1 %.
constexpr double kMapTolerance = 0.003;

/// The scene with an environment map.
constexpr std::string_view kWithMap = "skylight";

/// Settings of the file, on one thread.
RenderSettings settings_of(const Scene& scene) {
  const nlohmann::json asked = nlohmann::json::parse(scene.settings_json);
  RenderSettings settings = small_settings(asked.at("width"), asked.at("height"));
  settings.path.max_bounces = asked.at("max-bounces");
  return settings;
}

Scene load(const char* name, const char* format) {
  Scene scene = load_scene(kFolder / (std::string(name) + "." + format));
  for (const std::string& warning : scene.warnings) ADD_FAILURE() << warning;
  return scene;
}

Moments images_of(const Scene& scene, int spp, size_t format) {
  return measure(scene, settings_of(scene), spp, kImages, kSeedsPerFormat * static_cast<int>(format) + 1);
}

/// The same images, mirrored.
Moments mirrored(const Moments& moments) {
  std::vector<Image> images = moments.images;
  for (Image& image : images) {
    for (auto row = image.pixels.begin(); row != image.pixels.end(); row += image.width)
      std::reverse(row, row + image.width);
  }
  return moments_of(std::move(images));
}

/// The scene of a pbrt file without the line that makes its world right-handed.
Scene load_left_handed(const char* name) {
  const Bytes bytes = read_file_bytes(kFolder / (std::string(name) + ".pbrt"));
  std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const std::string line = "Scale -1 1 1\n";
  text.erase(text.find(line), line.size());
  return load_pbrt_from_memory(std::as_bytes(std::span(text)), kFolder, "left-handed.pbrt");
}

class SceneFormats : public ::testing::TestWithParam<Case> {};

// Seeds differ between formats. Differences count without tolerance, except those of environment maps. With the
// thresholds of ImageTestOptions for pixels, blocks and means, equal images of all ten scenes are rejected with a
// probability of 1 %.
TEST_P(SceneFormats, GiveTheSameImage) {
  const Case& c = GetParam();
  std::vector<Moments> images;
  for (size_t i = 0; i < kFormats.size(); ++i) images.push_back(images_of(load(c.name, kFormats[i]), c.spp, i));
  const bool has_map = c.name == kWithMap;
  const ImageTestOptions options{
      .pixels = !has_map, .tolerance = has_map ? kMapTolerance : 0, .detectable = c.blocks, .detectable_mean = c.mean};
  for (size_t i = 0; i < kFormats.size(); ++i) {
    const size_t other = (i + 1) % kFormats.size();
    const std::string pair = std::string(c.name) + "-" + kFormats[i] + "-" + kFormats[other];
    expect_same_image("formats-" + pair, images[i], images[other], options);
    EXPECT_GT(compare(mirrored(images[i]), images[other], options).rejected_blocks, 0)
        << pair << ": a mirrored image would pass";
  }
}

std::string case_name(const ::testing::TestParamInfo<Case>& info) { return info.param.name; }

INSTANTIATE_TEST_SUITE_P(Scenes, SceneFormats, ::testing::ValuesIn(kCases), case_name);

TEST(MirroredFormat, IsRejected) {
  const Scene scene = load("sun", "gltf");
  const Scene wrong = load_left_handed("sun");
  const ImageTest test = compare(images_of(wrong, 8, 0), images_of(scene, 8, 1), {.tolerance = 0});
  EXPECT_GT(test.rejected_blocks, 0) << test.report();
  EXPECT_GT(test.rejected_pixels, 0) << test.report();
}

}  // namespace
}  // namespace relume::support
