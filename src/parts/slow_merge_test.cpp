// Parts of more techniques, and of a scene with textures. RELUME_SCENES is the folder of sponza/sponza.gltf.
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "files/testing/temp_folder.h"
#include "parts/testing/rendered_parts.h"
#include "relume/error.h"
#include "relume/merge.h"
#include "relume/scene_io.h"
#include "render/build_pipeline.h"
#include "render/sample_parts.h"

namespace relume {
namespace {

const std::vector<std::string> kLayers{"albedo", "normal", "depth", "motion", "variance", "heatmap", "radiance"};

RenderSettings settings_of(int width, int height) {
  RenderSettings settings;
  settings.width = width;
  settings.height = height;
  settings.threads = 2;
  return settings;
}

/// Eight parts of 16 samples, in the order of their samples.
std::vector<std::filesystem::path> write_eight(const testing::PartRenderer& renderer, const TempFolder& folder) {
  std::vector<std::filesystem::path> parts;
  for (uint32_t i = 0; i < 8; ++i) {
    parts.push_back(folder / (std::to_string(i) + ".exr"));
    renderer.write(parts.back(), {16 * i, 16 * i + 15});
  }
  return parts;
}

void merge_in_order(const std::vector<std::filesystem::path>& parts, const std::vector<size_t>& order,
                    const std::filesystem::path& output) {
  std::vector<std::filesystem::path> ordered;
  for (const size_t i : order) ordered.push_back(parts[i]);
  merge_images(ordered, output);
}

void expect_merge_of_eight(const testing::PartRenderer& renderer, const std::string& what) {
  SCOPED_TRACE(what);
  const TempFolder folder;
  merge_in_order(write_eight(renderer, folder), {5, 2, 7, 0, 3, 6, 1, 4}, folder / "out.exr");
  testing::expect_same_channels(read_exr(folder / "out.exr"), renderer.whole(128));
}

/// Expects that the parts are refused for a reason that holds this text, and that no file is written.
void expect_refusal(const std::vector<std::filesystem::path>& parts, const TempFolder& folder,
                    const std::string& reason) {
  const std::filesystem::path output = folder / "refused.exr";
  try {
    merge_images(parts, output);
    ADD_FAILURE() << "merged, although: " << reason;
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
  }
  EXPECT_FALSE(std::filesystem::exists(output)) << reason;
}

TEST(SlowMerge, OfEveryChoiceThatDoesNotAdaptHasTheBitsOfOneRun) {
  const auto scene = [] { return find_builtin_scene("cornell")->build(); };
  size_t merged = 0;
  RenderSettings names;
  for (const Setting& slot : describe_slots(names)) {
    for (const std::string_view value : std::get<ChoiceRef>(slot.value).names) {
      RenderSettings settings = settings_of(16, 12);
      const SettingList slots = describe_slots(settings);
      assign(require_setting(slots, slot.name, "slots"), value, slot.name);
      if (value == "oidn" || !sums_refusal(settings).empty() || samples_adapt(settings)) continue;
      expect_merge_of_eight({scene, settings, kLayers}, slot.name + " " + std::string(value));
      ++merged;
    }
  }
  EXPECT_EQ(merged, 15u) << "4 estimators, 4 kinds of light sampling, 2 of reuse, and 1 choice in each other slot";
}

TEST(SlowMerge, OfSettingsThatUseTheNumberOfTheFrameHasTheBitsOfOneRun) {
  const auto scene = [] { return find_builtin_scene("cornell")->build(); };
  const auto with = [&](const auto& change, const char* what) {
    RenderSettings settings = settings_of(16, 12);
    change(settings);
    expect_merge_of_eight({scene, settings, kLayers}, what);
  };
  with([](RenderSettings& s) { s.stratify = false; }, "random numbers without strata");
  with([](RenderSettings& s) { s.dither = true; }, "dithering");
  with([](RenderSettings& s) { s.firefly.limit = 8; }, "firefly clamp");
  with([](RenderSettings& s) { s.path.indirect_rate = 0.5f; }, "indirect light at half of the pixels");
  with([](RenderSettings& s) { s.seed = 12345; }, "seed");
  with([](RenderSettings& s) { s.scalar_kernels = true; }, "device form of kernels");
}

/// Eight parts of Sponza and their refusals share the slow renders.
TEST(SlowMerge, OfSponzaInAnyOrderHasTheBitsOfOneRunAndOthersAreRefused) {
  const char* scenes = std::getenv("RELUME_SCENES");
  const std::filesystem::path file = std::filesystem::path(scenes ? scenes : "") / "sponza" / "sponza.gltf";
  if (!scenes || !std::filesystem::exists(file)) GTEST_SKIP() << "RELUME_SCENES names no folder with Sponza";
  const auto hall = [&file] {
    Scene scene = load_scene(file.string());
    scene.environment.kind = EnvironmentKind::constant;
    scene.environment.color = Rgb(0.25f, 0.3f, 0.4f);
    return scene;
  };
  const RenderSettings settings = settings_of(160, 90);
  const testing::PartRenderer renderer(hall, settings, kLayers);
  const TempFolder folder;
  const std::vector<std::filesystem::path> parts = write_eight(renderer, folder);
  const ExrFile whole = renderer.whole(128);
  for (const std::vector<size_t>& order :
       {std::vector<size_t>{0, 1, 2, 3, 4, 5, 6, 7}, {7, 6, 5, 4, 3, 2, 1, 0}, {5, 2, 7, 0, 3, 6, 1, 4}}) {
    SCOPED_TRACE(order.front());
    merge_in_order(parts, order, folder / "out.exr");
    testing::expect_same_channels(read_exr(folder / "out.exr"), whole);
  }
  std::vector<std::filesystem::path> seven(parts.begin(), parts.end() - 1);
  const auto with = [&](const std::filesystem::path& last) {
    std::vector<std::filesystem::path> eight = seven;
    eight.push_back(last);
    return eight;
  };
  expect_refusal(with(parts.front()), folder, "share samples (0-15 and 0-15)");
  const std::filesystem::path other = folder / "other.exr";
  const auto box = [] { return find_builtin_scene("cornell")->build(); };
  testing::PartRenderer(box, settings, kLayers).write(other, {112, 127});
  expect_refusal(with(other), folder, "different scenes");
  RenderSettings shorter = settings;
  shorter.path.max_bounces -= 1;
  testing::PartRenderer(hall, shorter, kLayers).write(other, {112, 127});
  expect_refusal(with(other), folder, "has max-bounces '");
  std::filesystem::resize_file(parts.back(), std::filesystem::file_size(parts.back()) / 2);
  expect_refusal(parts, folder, parts.back().filename().string());
}

}  // namespace
}  // namespace relume
