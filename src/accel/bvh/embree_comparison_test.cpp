// Compares the BVH with Embree in the built-in scenes.
#include <cmath>
#include <iostream>
#include <memory>
#include <span>

#include <gtest/gtest.h>

#include "accel/embree_accel.h"
#include "accel/host_accel.h"
#include "accel/testing/scene_rays.h"
#include "builtin_scenes/builtin.h"

namespace relume {
namespace {

using testing::SceneRays;

/// Hits that are this close to an edge may be on either side by Embree's rounding; see distance_to_edge().
constexpr float kAtEdge = 1e-5f;

struct Differences {
  size_t rays = 0;
  size_t at_edges = 0;
  size_t undecidable = 0;  ///< coincident faces, and origins on a surface
};

/// Distance of a hit from the nearest edge of its triangle, as a fraction of its distance from the world's or the ray's
/// origin, whichever is larger: the scale of rounding errors.
float distance_to_edge(const SceneView& scene, const Hit& hit) {
  const Instance& instance = scene.instances[hit.instance];
  Vec3 corners[3];
  for (int k = 0; k < 3; ++k) corners[k] = testing::world_corner(scene, instance, hit.primitive, k);
  const float weights[3] = {1 - hit.u - hit.v, hit.u, hit.v};
  const float twice_area = glm::length(glm::cross(corners[1] - corners[0], corners[2] - corners[0]));
  float least = kInfinity;
  float reach = hit.t;
  for (int k = 0; k < 3; ++k) {
    const float edge = glm::length(corners[(k + 2) % 3] - corners[(k + 1) % 3]);
    least = min(least, weights[k] * twice_area / edge);
    reach = max(reach, max_component(abs(corners[k])));
  }
  return least / reach;
}

/// Expects equal bits on the same triangle. Other pairs of hits must be at an edge, at the same distance, or at t ≈ 0.
void compare_hits(const SceneView& scene, const Hit& embree, const Hit& bvh, Differences& found) {
  ++found.rays;
  if (embree.instance == bvh.instance && embree.primitive == bvh.primitive) {
    EXPECT_EQ(embree.t, bvh.t);
    EXPECT_EQ(embree.u, bvh.u);
    EXPECT_EQ(embree.v, bvh.v);
    return;
  }
  const Hit& nearer = embree.t < bvh.t ? embree : bvh;
  const bool at_same_distance = std::fabs(embree.t - bvh.t) <= 1e-6f * nearer.t;
  const float from_edge = distance_to_edge(scene, nearer);
  if (from_edge >= kAtEdge && (at_same_distance || nearer.t < 1e-6f)) {
    ++found.undecidable;
    return;
  }
  ++found.at_edges;
  EXPECT_LT(from_edge, kAtEdge) << embree.t << " and " << bvh.t;
}

void compare(const SceneView& scene, const AccelView& embree, const AccelView& bvh, const SceneRays& rays,
             Differences& found) {
  for (uint32_t i = 0; i < rays.primary.size(); ++i) {
    const Ray& ray = rays.primary[i];
    compare_hits(scene, intersect_from_camera(embree, ray, i), intersect_from_camera(bvh, ray, i), found);
  }
  for (uint32_t i = 0; i < rays.diffuse.size(); ++i)
    compare_hits(scene, intersect(embree, rays.diffuse[i], i), intersect(bvh, rays.diffuse[i], i), found);
  for (uint32_t i = 0; i < rays.shadow.size(); ++i) {
    const Ray& ray = rays.shadow[i];
    const Hit by_bvh = intersect(bvh, ray, i);
    EXPECT_EQ(occluded(bvh, ray, i), by_bvh.valid());
    if (occluded(embree, ray, i) == by_bvh.valid()) {
      ++found.rays;
    } else {
      compare_hits(scene, intersect(embree, ray, i), by_bvh, found);
    }
  }
}

/// Embree's structure in its robust mode, for a scene that was compiled with Embree.
std::unique_ptr<AccelStructure> robust_embree(const SceneView& scene) {
  const HostAccelData& host = *scene.accel.host.data;
  return std::make_unique<EmbreeAccel>(std::span(host.meshes, scene.meshes.size),
                                       std::span(host.instances, scene.instances.size), host.opacity, true);
}

/// Compares in every built-in scene, at several times if it moves. `width`, `height`: size of an image of rays.
/// `robust`: with Embree's robust mode.
Differences compare_everywhere(int width, int height, uint32_t images, bool robust) {
  Differences found;
  for (const BuiltinScene& builtin : builtin_scenes()) {
    SCOPED_TRACE(builtin.name);
    CompiledScene by_embree(builtin.build(), {.width = width, .height = height});
    CompiledScene by_bvh(builtin.build(), {.width = width, .height = height, .accel = AccelChoice::bvh});
    for (uint32_t image = 0; image < images; ++image) {
      const SceneRays rays = testing::scene_rays(by_embree, width, height, image);
      const std::unique_ptr<AccelStructure> other = robust ? robust_embree(by_embree.view()) : nullptr;
      const AccelView embree = other ? other->view() : by_embree.view().accel;
      compare(by_embree.view(), embree, by_bvh.view().accel, rays, found);
      by_embree.set_time(1.3f * static_cast<float>(image + 1));
      by_bvh.set_time(1.3f * static_cast<float>(image + 1));
    }
  }
  return found;
}

TEST(BvhAgainstEmbree, FindsTheSameHits) {
  const Differences found = compare_everywhere(64, 36, 2, false);
  EXPECT_GT(found.rays, 150'000u);
  EXPECT_LE(found.at_edges, 2u);
  EXPECT_LE(found.undecidable, 5u);
}

/// Compares ten million rays, and prints how many of a million differ.
Differences compare_many(bool robust) {
  const Differences found = compare_everywhere(336, 189, 4, robust);
  const double million = 1e-6 * static_cast<double>(found.rays);
  const auto per_million = [&](size_t count) { return static_cast<double>(count) / million; };
  std::cerr << (robust ? "robust Embree: " : "Embree: ") << found.rays << " rays; of a million, "
            << per_million(found.at_edges) << " find another triangle at an edge, and "
            << per_million(found.undecidable) << " another of two coincident triangles\n";
  EXPECT_GT(found.rays, 10'000'000u);
  EXPECT_LT(per_million(found.at_edges), 3);
  EXPECT_LT(per_million(found.undecidable), 10);
  return found;
}

/// Most differences at edges are in `city` and `mine`, whose triangles are small and far away. Embree's fast mode
/// rounds there; its robust mode shows how many of them that explains.
TEST(SlowBvhAgainstEmbree, FindsTheSameHits) {
  const Differences fast = compare_many(false);
  const Differences robust = compare_many(true);
  EXPECT_LE(robust.at_edges, fast.at_edges);
}

}  // namespace
}  // namespace relume
