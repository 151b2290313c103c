#include "scene/framing.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "scene/compiled_scene.h"
#include "scene/testing/plate.h"

namespace relume {
namespace {

/// Largest distance of a vertex from the image centre, 1 at the border.
Vec2 filled(const Scene& scene, int width, int height) {
  const CompiledScene compiled(scene, {.width = width, .height = height});
  const SceneView& view = compiled.view();
  Vec2 low(kInfinity);
  Vec2 high(-kInfinity);
  for (const Vertex& v : view.vertices) {
    const Vec3 local = view.camera.axes.to_local(v.position - view.camera.position);
    EXPECT_LT(local.z, 0.0f) << "behind the camera";
    const Vec2 ndc = Vec2(local) / (-local.z * view.camera.half_extent);
    low = glm::min(low, ndc);
    high = glm::max(high, ndc);
  }
  EXPECT_LE(std::max(-low.x, high.x), kFramedShare + 1e-4f);
  EXPECT_LE(std::max(-low.y, high.y), kFramedShare + 1e-4f);
  EXPECT_NEAR(-low.x, high.x, 5e-3f) << "not in the middle";
  EXPECT_NEAR(-low.y, high.y, 5e-3f) << "not in the middle";
  return 0.5f * (high - low);
}

Scene block(const Vec3& size) {
  Scene scene = testing::plate();
  scene.nodes.resize(1);
  scene.cameras.clear();
  Mesh& mesh = scene.meshes[0];
  mesh.positions.clear();
  for (int i = 0; i < 8; ++i) mesh.positions.push_back(Vec3(i & 1, i >> 1 & 1, i >> 2) * size + Vec3(5, -3, 11));
  mesh.triangles = {{0, 1, 2}, {1, 3, 2}, {4, 6, 5}, {5, 6, 7}, {0, 4, 1}, {2, 3, 6}};
  return scene;
}

TEST(Framing, FillsTheImageInOneDimension) {
  for (const Vec3& size :
       {Vec3(1), Vec3(20, 1, 1), Vec3(1, 30, 1), Vec3(1e-3f, 2e-3f, 5e-3f), Vec3(0, 400, 300), Vec3(3e4f)}) {
    for (const IVec2& resolution : {IVec2(160, 90), IVec2(90, 160)}) {
      const Vec2 share = filled(block(size), resolution.x, resolution.y);
      EXPECT_NEAR(std::max(share.x, share.y), kFramedShare, 2e-3f) << size.x << ' ' << size.y << ' ' << resolution.x;
    }
  }
}

}  // namespace
}  // namespace relume
