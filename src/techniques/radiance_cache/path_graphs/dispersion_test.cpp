// Caches in scenes whose paths have wavelengths.
#include <gtest/gtest.h>

#include <utility>

#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"
#include "techniques/radiance_cache/path_graphs/testing/cached_frames.h"

namespace relume::testing {
namespace {

class DispersiveCaches : public ::testing::TestWithParam<CacheKind> {};

Material dispersive_glass(float color, float roughness, float dispersion) {
  Material glass = matte(Rgb(color));
  glass.specular = 1;
  glass.transmission = 1;
  glass.roughness = roughness;
  glass.thickness = 1;
  glass.dispersion = dispersion;
  return glass;
}

void add_ball(Scene& scene, const Vec3& center, float roughness) {
  Mesh ball = flat_shaded(icosphere(0.45f, 3));
  for (Vec3& p : ball.positions) p += center;
  add_mesh(scene, dispersive_glass(1, roughness, 3), std::move(ball));
}

/// Balls of smooth and of frosted glass above a plate.
Scene dispersive_balls() {
  Scene scene = plate_under_sky(matte(Rgb(0.7f, 0.5f, 0.3f)));
  scene.nodes.back().transform.translation.y = 3;
  add_ball(scene, {-0.5f, 0.6f, 0}, 0);
  add_ball(scene, {0.5f, 0.6f, 0}, 0.3f);
  return scene;
}

/// The inner side of tinted frosted glass. Light that leaves it is tinted, and reflected light is not.
Scene inside_a_medium() {
  Scene scene;
  scene.name = "inside";
  add_mesh(scene, dispersive_glass(0.5f, 0.3f, 2), box({-1, -1, -1}, {1, 1, 1}));
  Camera camera;
  camera.fov_y_rad = 1.2f;
  add_camera(scene, camera, {0.1f, 0.2f, 0.5f}, glm::quat(1, 0, 0, 0));
  scene.environment.kind = EnvironmentKind::constant;
  scene.environment.color = Rgb(1);
  return scene;
}

/// After some frames, in which cells learn.
glm::dvec3 mean_of_frames(Scene scene, CacheKind kind) {
  constexpr int kSkipped = 16;
  constexpr int kFrames = 256;
  CachedFrameSettings settings;
  settings.kind = kind;
  settings.width = settings.height = 24;
  CachedFrames frames(std::move(scene), settings);
  glm::dvec3 sum(0);
  for (int i = 0; i < kSkipped + kFrames; ++i) {
    const std::vector<Rgb>& image = frames.render();
    if (i < kSkipped) continue;
    for (const Rgb& p : image) sum += glm::dvec3(p) / (static_cast<double>(image.size()) * kFrames);
  }
  return sum;
}

/// `expected`: the mean without a cache.
void expect_mean_of_paths(const Scene& scene, CacheKind kind, const glm::dvec3& expected, double tolerance) {
  const glm::dvec3 mean = mean_of_frames(scene, kind);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / expected[c], 1.0, tolerance) << "channel " << c;
}

/// A weight of the wavelength that counted twice would make channels up to 2.6 times too bright.
TEST_P(DispersiveCaches, KeepTheMeanOfEachChannel) {
  static const glm::dvec3 expected = mean_of_frames(dispersive_balls(), CacheKind::none);
  expect_mean_of_paths(dispersive_balls(), GetParam(), expected, 0.01);
}

/// No path has a cell, so the frames are those of path tracing.
TEST_P(DispersiveCaches, BypassTheInnerSideOfAnInterface) {
  static const glm::dvec3 expected = mean_of_frames(inside_a_medium(), CacheKind::none);
  expect_mean_of_paths(inside_a_medium(), GetParam(), expected, 1e-6);
}

std::string case_name(const ::testing::TestParamInfo<CacheKind>& info) { return name_of(info.param); }
INSTANTIATE_TEST_SUITE_P(AllCaches, DispersiveCaches, ::testing::ValuesIn(kCacheKinds), case_name);

}  // namespace
}  // namespace relume::testing
