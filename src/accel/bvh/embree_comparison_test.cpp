// Compares the BVH with Embree in the built-in scenes.
#include <algorithm>
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

/// Hits that are this close to an edge may be on either side by rounding, as a fraction of HitTriangle::reach: 168 u,
/// with u = 2⁻²⁴. By the bounds in box_ray.h, the BVH moves an edge per axis by at most 19 u M (6 u M without an
/// instance). M, the sum of the largest coordinates of corners and origin, is at most three times the reach: 57 u. The
/// rest is for Embree, which states no bound.
constexpr float kAtEdge = 1e-5f;

struct Differences {
  size_t rays = 0;
  size_t at_edges = 0;
  size_t at_shared_edges = 0;  ///< of these, pairs of triangles that share the edge
  size_t undecidable = 0;      ///< coincident faces, and origins on a surface
  float largest_step = 0;      ///< difference of t at shared edges, as a fraction of the reach
};

/// A triangle that a ray hits, in world space.
struct HitTriangle {
  Vec3 corners[3];
  float from_edges[3];  ///< distance of the hit from the edge opposite of each corner, metres
  float reach;  ///< scale of rounding errors: the largest of the hit's distances from the ray's and the world's origin
  float slope;  ///< sine of its angle to the ray, times the sine of its angle at the first corner

  HitTriangle(const SceneView& scene, const Ray& ray, const Hit& hit) : reach(hit.t) {
    const Instance& instance = scene.instances[hit.instance];
    for (int k = 0; k < 3; ++k) corners[k] = testing::world_corner(scene, instance, hit.primitive, k);
    const float weights[3] = {1 - hit.u - hit.v, hit.u, hit.v};
    const Vec3 e1 = corners[1] - corners[0];
    const Vec3 e2 = corners[2] - corners[0];
    const Vec3 normal = glm::cross(e1, e2);
    for (int k = 0; k < 3; ++k) {
      from_edges[k] = weights[k] * glm::length(normal) / glm::length(corners[(k + 2) % 3] - corners[(k + 1) % 3]);
      reach = max(reach, max_component(abs(corners[k])));
    }
    slope = std::fabs(glm::dot(normal, ray.direction)) / (glm::length(e1) * glm::length(e2));
  }

  /// The least distance from an edge, as a fraction of the reach.
  float from_edge() const { return std::min({from_edges[0], from_edges[1], from_edges[2]}) / reach; }

  /// Whether the hit is at an edge that `other` has, too.
  bool is_at_edge_of(const HitTriangle& other) const {
    const auto has = [&](const Vec3& p) { return std::ranges::count(other.corners, p) > 0; };
    for (int k = 0; k < 3; ++k) {
      if (from_edges[k] < kAtEdge * reach && has(corners[(k + 1) % 3]) && has(corners[(k + 2) % 3])) return true;
    }
    return false;
  }
};

/// Where two triangles share the edge, the ray passes the edge at a distance of at most d = kAtEdge · reach. It thus
/// meets each plane within d / slope of that place. The rounding of t, a few u · reach / slope, is far smaller. Other
/// pairs have no bound: beside a silhouette, the second hit is on whatever is behind it.
void compare_at_edge(const HitTriangle& nearer, const HitTriangle& farther, float nearer_t, float farther_t,
                     Differences& found) {
  if (!nearer.is_at_edge_of(farther)) return;
  ++found.at_shared_edges;
  const float step = farther_t - nearer_t;
  EXPECT_LE(step * std::min(nearer.slope, farther.slope), 2 * kAtEdge * std::max(nearer.reach, farther.reach))
      << nearer_t << " and " << farther_t;
  found.largest_step = std::max(found.largest_step, step / nearer.reach);
}

/// Expects equal bits on the same triangle. Other pairs of hits must be at an edge, at the same distance, or at t ≈ 0.
void compare_hits(const SceneView& scene, const Ray& ray, const Hit& embree, const Hit& bvh, Differences& found) {
  ++found.rays;
  if (embree.instance == bvh.instance && embree.primitive == bvh.primitive) {
    EXPECT_EQ(embree.t, bvh.t);
    EXPECT_EQ(embree.u, bvh.u);
    EXPECT_EQ(embree.v, bvh.v);
    return;
  }
  const bool embree_is_nearer = embree.t < bvh.t;
  const Hit& nearer = embree_is_nearer ? embree : bvh;
  const Hit& farther = embree_is_nearer ? bvh : embree;
  const bool at_same_distance = std::fabs(embree.t - bvh.t) <= 1e-6f * nearer.t;
  const HitTriangle triangle(scene, ray, nearer);
  if (triangle.from_edge() >= kAtEdge && (at_same_distance || nearer.t < 1e-6f)) {
    ++found.undecidable;
    return;
  }
  ++found.at_edges;
  EXPECT_LT(triangle.from_edge(), kAtEdge) << embree.t << " and " << bvh.t;
  if (farther.valid()) compare_at_edge(triangle, HitTriangle(scene, ray, farther), nearer.t, farther.t, found);
}

void compare(const SceneView& scene, const AccelView& embree, const AccelView& bvh, const SceneRays& rays,
             Differences& found) {
  for (uint32_t i = 0; i < rays.primary.size(); ++i) {
    const Ray& ray = rays.primary[i];
    compare_hits(scene, ray, intersect_from_camera(embree, ray, i), intersect_from_camera(bvh, ray, i), found);
  }
  for (uint32_t i = 0; i < rays.diffuse.size(); ++i) {
    const Ray& ray = rays.diffuse[i];
    compare_hits(scene, ray, intersect(embree, ray, i), intersect(bvh, ray, i), found);
  }
  for (uint32_t i = 0; i < rays.shadow.size(); ++i) {
    const Ray& ray = rays.shadow[i];
    const Hit by_bvh = intersect(bvh, ray, i);
    EXPECT_EQ(occluded(bvh, ray, i), by_bvh.valid());
    if (occluded(embree, ray, i) == by_bvh.valid()) {
      ++found.rays;
    } else {
      compare_hits(scene, ray, intersect(embree, ray, i), by_bvh, found);
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
    const Scene scene = builtin.build();
    CompiledScene by_embree(scene, {.width = width, .height = height});
    CompiledScene by_bvh(scene, {.width = width, .height = height, .accel = AccelChoice::bvh});
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
            << per_million(found.at_edges) << " find another triangle at an edge ("
            << per_million(found.at_shared_edges) << " of two that share it, with distances that differ by at most "
            << found.largest_step << " of the scale of rounding errors), and " << per_million(found.undecidable)
            << " another of two coincident triangles\n";
  EXPECT_GT(found.rays, 10'000'000u);
  EXPECT_LT(per_million(found.at_edges), 3);
  EXPECT_LT(per_million(found.undecidable), 10);
  return found;
}

/// The goal of less than one ray in a million at edges is missed (docs/performance.md). Most differences at edges are
/// in `city` and `mine`, whose triangles are small and far away. Embree's fast mode rounds there; its robust mode shows
/// how many of them that explains.
TEST(SlowBvhAgainstEmbree, FindsTheSameHits) {
  const Differences fast = compare_many(false);
  const Differences robust = compare_many(true);
  EXPECT_LE(robust.at_edges, fast.at_edges);
}

}  // namespace
}  // namespace relume
