// Tests that a built-in scene and its glTF file give the same image.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <string>
#include <tuple>

#include "builtin_scenes/builtin.h"
#include "relume/lab/metrics.h"
#include "relume/scene_io.h"
#include "support/image_test.h"
#include "support/scenes.h"
#include "support/test_name.h"

namespace relume::support {
namespace {

/// Scenes of millions of triangles, tested only under the label "slow".
bool is_large(std::string_view name) { return name == "city" || name == "cover"; }

using ExportCase = std::tuple<std::string_view, const char*>;  // scene, extension

RenderSettings settings_of(std::string_view scene) {
  RenderSettings settings = is_large(scene) ? small_settings(16, 9) : small_settings(32, 24);
  settings.time_s = 0.4f;  // within all animations
  return settings;
}

class Export : public ::testing::TestWithParam<ExportCase> {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) / ("relume_export_" + std::to_string(::getpid()));
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string_view scene_name() const { return std::get<0>(GetParam()); }

  Scene original() const { return find_builtin_scene(scene_name())->build(); }
  Scene reread() const {
    const std::filesystem::path file = folder_ / (std::string("scene") + std::get<1>(GetParam()));
    for (const std::string& loss : write_gltf(file, original())) RecordProperty("loss", loss);
    return load_scene(file);
  }

 private:
  std::filesystem::path folder_;
};

std::string export_name(const ::testing::TestParamInfo<ExportCase>& info) {
  return test_name(std::string(std::get<0>(info.param)) + std::get<1>(info.param));
}

TEST_P(Export, ReloadedSceneRendersTheSameImage) {
  const RenderSettings settings = settings_of(scene_name());
  const Scene before = original();
  const Scene after = reread();
  // Most scenes are restored bit by bit. Others contain values that glTF encodes differently (instances, angles), which
  // moves few samples across edges. The city has the most of these, and few pixels.
  const int spp = is_large(scene_name()) ? 64 : 4;
  const Image a = render(after, settings, spp);
  const Image b = render(before, settings, spp);
  EXPECT_LT(compute_metrics(a, b).rel_mse, 1e-3);
}

/// Settings with low enough noise to compare a scene's mean, and the detectable errors.
struct MeanCase {
  RenderSettings settings;
  int spp = 64;
  ImageTestOptions options;
};

MeanCase mean_case_of(std::string_view scene) {
  MeanCase c{.settings = settings_of(scene), .spp = is_large(scene) ? 16 : 64, .options = {}};
  const auto is = [&](auto... names) { return ((scene == names) || ...); };
  if (is("cornell-water", "cornell-glass", "corridor", "door", "lamp-room"))
    c.settings.estimator = EstimatorChoice::bdpt;
  if (is("warehouse", "cover")) c.settings.lights = LightSelectionChoice::vlc;
  if (is("cornell-water", "cornell-glass", "corridor")) c.spp = 512;
  if (is("cover")) c.spp = 128;
  if (is("cornell-water")) c.options = {.detectable = 0.3, .detectable_mean = 0.1};  // lamp of a few pixels
  if (is("cover")) c.options = {.detectable = 0.15, .detectable_mean = 0.1};
  return c;
}

/// Uses different seeds, so that only means can agree.
class SlowExport : public Export {};

TEST_P(SlowExport, ReloadedSceneAgreesInTheMean) {
  const MeanCase c = mean_case_of(scene_name());
  expect_same_image("export-" + export_name({GetParam(), 0}), measure(reread(), c.settings, c.spp, 16, 1),
                    measure(original(), c.settings, c.spp, 16, 1001), c.options);
}

/// A scene with every property that glTF cannot represent.
Scene beyond_gltf() {
  Scene scene;
  scene.name = "beyond";
  Material floor = glossy("floor", {0.5f, 0.4f, 0.3f}, 0.4f);
  floor.microfacet_model = MicrofacetModel::beckmann;
  add(scene, quad({-2, -1, -4}, {0, 0, 6}, {4, 0, 0}), floor);
  Texture bright{
      .name = "bright", .width = 2, .height = 1, .format = PixelFormat::rgba32_float, .texels = {}, .file = {}};
  const float texels[] = {4, 0.125f, 2, 1, 0.25f, 9, 0, 1};
  const std::byte* bytes = reinterpret_cast<const std::byte*>(texels);
  bright.texels.assign(bytes, bytes + sizeof(texels));
  Material lamp = emitter("lamp", Rgb(1));
  lamp.emission_texture.texture = add_texture(scene, bright);
  add(scene, quad({-1, 0, -3}, {2, 0, 0}, {0, 1, 0}), lamp);
  PunctualLight sun{.name = "sun", .type = PunctualType::directional, .intensity = Rgb(2)};
  sun.angular_diameter_rad = 0.2f;
  add_light(scene, sun, look_at(Vec3(0), {1, -2, 0.5f}));
  Environment& sky = scene.environment;
  sky.kind = EnvironmentKind::map;
  sky.width = 8;
  sky.height = 4;
  for (int i = 0; i < 32; ++i) sky.map.emplace_back(static_cast<float>(i % 8), static_cast<float>(i / 8), 0.5f);
  sky.color = {0.25f, 0.5f, 1};
  sky.rotation_rad = 0.5f;
  return scene;
}

TEST(BeyondGltf, RoundTripsThroughExtras) {
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / ("relume_beyond_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  for (const Camera& camera : {Camera{.name = "lens", .fov_y_rad = 1, .lens_radius = 0.1f, .focus_distance = 3},
                               Camera{.name = "all round", .projection = Projection::panoramic}}) {
    Scene scene = beyond_gltf();
    add_camera(scene, camera, {0, 0.5f, 1}, {0, 0, -1});
    for (const char* file : {"scene.glb", "scene.gltf"}) {
      write_gltf(folder / file, scene);
      const Image before = render(scene, small_settings(32, 16), 16);
      const Image after = render(load_scene(folder / file), small_settings(32, 16), 16);
      // Angles are converted to degrees: a sample may cross an edge.
      EXPECT_LT(compute_metrics(after, before).rel_mse, 1e-4) << camera.name << ", " << file;
    }
  }
  std::filesystem::remove_all(folder);
}

/// Pairs of scene and extension, of either large or other scenes.
std::vector<ExportCase> export_cases(bool large) {
  std::vector<ExportCase> cases;
  for (const BuiltinScene& scene : builtin_scenes()) {
    if (is_large(scene.name) != large) continue;
    cases.emplace_back(scene.name, ".glb");
    cases.emplace_back(scene.name, ".gltf");
  }
  return cases;
}

INSTANTIATE_TEST_SUITE_P(Builtin, Export, ::testing::ValuesIn(export_cases(false)), export_name);
INSTANTIATE_TEST_SUITE_P(SlowBuiltin, Export, ::testing::ValuesIn(export_cases(true)), export_name);
INSTANTIATE_TEST_SUITE_P(Builtin, SlowExport, ::testing::ValuesIn(export_cases(false)), export_name);
INSTANTIATE_TEST_SUITE_P(Large, SlowExport, ::testing::ValuesIn(export_cases(true)), export_name);

}  // namespace
}  // namespace relume::support
