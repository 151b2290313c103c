// Caches in scenes whose paths have wavelengths.
#include <gtest/gtest.h>

#include "techniques/radiance_cache/path_graphs/testing/cache_scenes.h"
#include "techniques/radiance_cache/path_graphs/testing/cached_frames.h"

namespace relume::testing {
namespace {

class DispersiveCaches : public ::testing::TestWithParam<CacheKind> {};

void add_ball(Scene& scene, const Vec3& center, float roughness) {
  Material glass = matte(Rgb(1));
  glass.specular = 1;
  glass.transmission = 1;
  glass.roughness = roughness;
  glass.thickness = 1;
  glass.dispersion = 3;
  Mesh ball = flat_shaded(icosphere(0.45f, 3));
  for (Vec3& p : ball.positions) p += center;
  add_mesh(scene, std::move(ball), glass);
}

/// Balls of smooth and of frosted glass above a plate.
Scene dispersive_balls() {
  Scene scene = plate_under_sky(matte(Rgb(0.7f, 0.5f, 0.3f)));
  scene.nodes.back().transform.translation.y = 3;
  add_ball(scene, {-0.5f, 0.6f, 0}, 0);
  add_ball(scene, {0.5f, 0.6f, 0}, 0.3f);
  return scene;
}

/// After some frames, in which cells learn.
glm::dvec3 mean_of_frames(CacheKind kind) {
  constexpr int kSkipped = 16;
  constexpr int kFrames = 256;
  CachedFrameSettings settings;
  settings.kind = kind;
  settings.width = settings.height = 24;
  CachedFrames frames(dispersive_balls(), settings);
  glm::dvec3 sum(0);
  for (int i = 0; i < kSkipped + kFrames; ++i) {
    const std::vector<Rgb>& image = frames.render();
    if (i < kSkipped) continue;
    for (const Rgb& p : image) sum += glm::dvec3(p) / (static_cast<double>(image.size()) * kFrames);
  }
  return sum;
}

/// A weight of the wavelength that counted twice would make channels up to 2.6 times too bright.
TEST_P(DispersiveCaches, KeepTheMeanOfEachChannel) {
  const glm::dvec3 expected = mean_of_frames(CacheKind::none);
  const glm::dvec3 mean = mean_of_frames(GetParam());
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / expected[c], 1.0, 0.01) << "channel " << c;
}

std::string case_name(const ::testing::TestParamInfo<CacheKind>& info) { return name_of(info.param); }
INSTANTIATE_TEST_SUITE_P(AllCaches, DispersiveCaches, ::testing::ValuesIn(kCacheKinds), case_name);

}  // namespace
}  // namespace relume::testing
