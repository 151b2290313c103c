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

void expect_merge_of_eight(const testing::PartRenderer& renderer, const std::string& what) {
  SCOPED_TRACE(what);
  const TempFolder folder;
  std::vector<std::filesystem::path> parts;
  for (const uint32_t i : {5u, 2u, 7u, 0u, 3u, 6u, 1u, 4u}) {
    parts.push_back(folder / (std::to_string(i) + ".exr"));
    renderer.write(parts.back(), {16 * i, 16 * i + 15});
  }
  merge_images(parts, folder / "out.exr");
  testing::expect_same_channels(read_exr(folder / "out.exr"), renderer.whole(128));
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

TEST(SlowMerge, OfSponzaHasTheBitsOfOneRun) {
  const char* folder = std::getenv("RELUME_SCENES");
  const std::filesystem::path file = std::filesystem::path(folder ? folder : "") / "sponza" / "sponza.gltf";
  if (!folder || !std::filesystem::exists(file)) GTEST_SKIP() << "RELUME_SCENES names no folder with Sponza";
  const auto scene = [&] {
    Scene hall = load_scene(file.string());
    hall.environment.kind = EnvironmentKind::constant;
    hall.environment.color = Rgb(0.25f, 0.3f, 0.4f);
    return hall;
  };
  expect_merge_of_eight({scene, settings_of(160, 90), kLayers}, "Sponza");
}

}  // namespace
}  // namespace relume
