// Caches in scenes whose paths have wavelengths.
#include <gtest/gtest.h>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/builtin.h"
#include "techniques/radiance_cache/path_graphs/testing/cached_frames.h"

namespace relume::testing {
namespace {

class DispersiveCaches : public ::testing::TestWithParam<CacheKind> {};

/// A strongly dispersive ball fills most of the view.
Scene dispersive_ball() {
  Scene scene = find_builtin_scene("cornell-glass")->build();
  for (Material& m : scene.materials) {
    if (m.thickness > 0.0f) m.dispersion = 3;
  }
  for (Node& node : scene.nodes) {
    if (node.camera != kNone) node.transform = look_at({0, 2.75f, 10.7f}, {-0.95f, 1.6f, -0.6f});
  }
  scene.cameras[0].fov_y_rad = 0.2f;
  return scene;
}

glm::dvec3 mean_over(CacheKind kind, int skip, int count) {
  CachedFrameSettings settings;
  settings.kind = kind;
  settings.width = settings.height = 24;
  CachedFrames frames(dispersive_ball(), settings);
  glm::dvec3 sum(0);
  for (int i = 0; i < skip + count; ++i) {
    const std::vector<Rgb>& image = frames.render();
    if (i < skip) continue;
    for (const Rgb& p : image) sum += glm::dvec3(p) / (static_cast<double>(image.size()) * count);
  }
  return sum;
}

/// A weight of the wavelength that counted twice would make channels up to 2.6 times too bright.
TEST_P(DispersiveCaches, KeepTheMeanOfEachChannel) {
  constexpr int kFrames = 512;
  const glm::dvec3 expected = mean_over(CacheKind::none, 0, kFrames);
  const glm::dvec3 mean = mean_over(GetParam(), 16, kFrames);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / expected[c], 1.0, 0.045) << "channel " << c;
}

std::string case_name(const ::testing::TestParamInfo<CacheKind>& info) { return name_of(info.param); }
INSTANTIATE_TEST_SUITE_P(AllCaches, DispersiveCaches, ::testing::ValuesIn(kCacheKinds), case_name);

}  // namespace
}  // namespace relume::testing
