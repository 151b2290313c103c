// Tests of the levels of textures beyond primary hits.
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "scene/testing/textured_square.h"
#include "techniques/reuse/restir_gi/testing/posts.h"
#include "techniques/reuse/restir_pt/testing/traced_paths.h"
#include "techniques/transport/path/testing/run_kernel.h"

namespace relume {
namespace {

using testing::rule_of;
using testing::TracedPaths;

constexpr uint32_t kEdge = TracedPaths::kEdge;

/// A floor seen from above, and a ceiling above the camera, with textures whose texels are much smaller than pixels.
/// `mirror`: whether the floor is a mirror instead. The lamp lights the ceiling.
Scene textured_floor_and_ceiling(bool mirror) {
  Material tiles = testing::matte(Rgb(0.8f));
  tiles.base_color_texture.texture = 0;
  Material reflecting = testing::matte(Rgb(0.9f));
  reflecting.metallic = 1;
  reflecting.roughness = 0;
  Scene scene = testing::plate(mirror ? reflecting : tiles, 3, 1);
  scene.meshes[0].uv0 = testing::TexturedSquare::uv(30);
  Mesh ceiling = quad({-3, 2, -3}, {6, 0, 0}, {0, 0, 6});
  ceiling.uv0 = testing::TexturedSquare::uv(30);
  testing::add_mesh(scene, tiles, std::move(ceiling));
  scene.textures.push_back(testing::checkered(64));
  scene.lights.push_back(testing::ceiling_lamp(Rgb(20)));
  Node lamp;
  lamp.light = 0;
  lamp.transform.translation = Vec3(0.3f, 1, 0.2f);
  lamp.transform.rotation = glm::angleAxis(kPi / 2, Vec3(1, 0, 0));  // from -Z to +Y
  scene.add_node(lamp);
  return scene;
}

/// Number of pixels whose luminance differs from that of path tracing, of those with light.
struct Differences {
  int lit = 0;
  int different = 0;
};

Differences to_path_tracing(const Scene& scene, uint32_t max_bounces, bool has_cones) {
  const TracedPaths traced(scene, rule_of(PathShiftKind::hybrid), max_bounces, 3, has_cones);
  const CompiledScene compiled(scene, {.camera = {}, .width = kEdge, .height = kEdge});
  std::vector<Rgb> all(TracedPaths::kPixels);
  testing::trace_pixels(compiled, {.width = kEdge, .height = kEdge, .max_bounces = max_bounces},
                        RadianceOutput{mutable_view_of(all)});
  Differences result;
  for (uint32_t p = 0; p < TracedPaths::kPixels; ++p) {
    const PathReservoir& own = traced.reservoirs[p];
    const float truth = luminance(all[p]);
    if (!(truth > 0.0f)) continue;
    ++result.lit;
    if (std::fabs(luminance(own.sample.value) * own.weight - truth) > 1e-3f * truth) ++result.different;
  }
  return result;
}

/// Over a mirror, cones of path tracing are as narrow as those of pixels, and no vertex follows the joint.
TEST(PathCones, GiveTheTexturesOfPathTracing) {
  const Scene scene = textured_floor_and_ceiling(true);
  const Differences cones = to_path_tracing(scene, 2, true);
  EXPECT_GT(cones.lit, 300);
  EXPECT_LE(cones.different, cones.lit / 100);
  const Differences finest = to_path_tracing(scene, 2, false);
  EXPECT_GT(finest.different, finest.lit / 4);
}

/// Relative difference of luminances.
double difference(const Rgb& a, const Rgb& b) {
  const auto x = static_cast<double>(luminance(a));
  const auto y = static_cast<double>(luminance(b));
  return std::fabs(x - y) / std::max(x, y);
}

/// Otherwise, shifts would change the integrand.
TEST(PathCones, ArePropertiesOfThePath) {
  for (const PathShiftKind shift : {PathShiftKind::reconnection, PathShiftKind::replay, PathShiftKind::hybrid}) {
    const TracedPaths traced(textured_floor_and_ceiling(false), rule_of(shift), 4, 3, true);
    int paths = 0;
    int shifted = 0;
    int other = 0;
    for (uint32_t p = 0; p + 1 < TracedPaths::kPixels; ++p) {
      if (!traced.has_path(p)) continue;
      ++paths;
      const StoredPath& path = traced.reservoirs[p].sample;
      const Shifted self = traced.shifted(p, p);
      other += self.result == ShiftResult::defined && difference(self.value, path.value) < 0.01 ? 0 : 1;
      const Shifted there = traced.shifted(p, p + 1);
      if (there.result != ShiftResult::defined) continue;
      ++shifted;
      StoredPath moved = path;
      move_to(there, moved);
      const Shifted back = traced.shifted(moved, p);
      other += back.result == ShiftResult::defined && difference(back.value, path.value) < 0.01 ? 0 : 1;
    }
    EXPECT_GT(paths, 120);
    EXPECT_GT(shifted, 50);
    EXPECT_LE(other, 2 + paths / 50) << "of " << paths;
  }
}

}  // namespace
}  // namespace relume
