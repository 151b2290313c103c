// Traversal of the BVH: one source for host and device.
//
// The nearest hit is that of least (distance, instance, primitive). Whether a ray hits a triangle depends on these two
// only. So results do not depend on the shape of the tree or the order of visits.
#pragma once

#include "accel/bvh/box_ray.h"
#include "accel/bvh/layout.h"
#include "accel/bvh/sheared_ray.h"
#include "accel/bvh/timed_instance.h"
#include "accel/query.h"
#include "accel/triangle.h"

namespace relume {

/// TriangleCorners in world space at a time within the shutter, by the same operations as transform_point().
RELUME_HD_INLINE TriangleCorners placed_corners(const BvhView& bvh, uint32_t index, const BvhInstance* instance,
                                                float time) {
  const BvhTriangle& triangle = bvh.triangles[index];
  if (!instance) return {triangle.p0, triangle.p1, triangle.p2};
  if (instance->is_timed()) return corners_at(bvh, index, *instance, time);
  const auto place = [&](const Vec3& p) {
    const Vec3* m = instance->to_world;
    return m[0] * p.x + m[1] * p.y + m[2] * p.z + m[3];
  };
  return {place(triangle.p0), place(triangle.p1), place(triangle.p2)};
}

/// One query. `opacity(instance, primitive, u, v)` returns the opacity of a point, in [0, 1]. `postponed`: a stack for
/// the children of nodes that the ray visits later: PostponedChildren or PostponedNodes. It is outside of the object,
/// because compilers keep objects with arrays in memory.
template <bool kAnyHit, typename Postponed, typename Opacity>
class BvhTraversal {
 public:
  RELUME_HD BvhTraversal(const BvhView& bvh, const Ray& ray, uint32_t ray_id, unsigned camera, const Opacity& opacity,
                         Postponed& postponed)
      : bvh_(bvh),
        ray_(ray),
        ray_id_(ray_id),
        camera_(camera),
        opacity_(opacity),
        postponed_(postponed),
        sheared_(ray.origin, ray.direction),
        boxes_(ray.origin, ray.direction, Vec3(kBoxMargin), max_component(abs(ray.origin)),
               max_component(abs(ray.direction))),
        world_boxes_(boxes_),
        t_(ray.t_max) {}

  /// Finds the nearest hit, or any.
  RELUME_HD_INLINE void run() {
    BvhChild child = bvh_.root;
    while (!child.is_none()) {
      if (child.is_node()) {
        if (postponed_.descend(bvh_.nodes, boxes_, t_, size_, child)) continue;
      } else if (child.is_instance()) {
        child = enter(bvh_.instances[child.index()]);
        continue;
      } else {
        test(child);
        if (kAnyHit && found()) return;
      }
      child = pop();
    }
  }

  RELUME_HD bool found() const { return primitive_ != kNoHit; }

  RELUME_HD_INLINE Hit hit() const {
    if (!found()) return {};
    const TriangleCorners c = placed_corners(bvh_, triangle_, hit_node_, ray_.time);
    const TriangleHit on = intersect_triangle(ray_.origin, ray_.direction, c.p0, c.p1, c.p2);
    return {instance_, primitive_, on.u, on.v, on.t};
  }

 private:
  /// The next postponed child that the ray enters before the nearest hit so far.
  RELUME_HD_INLINE BvhChild pop() {
    for (;;) {
      if (node_ && size_ == node_floor_) leave();
      if (size_ == 0) return BvhChild::none();
      BvhChild child;
      if (postponed_.pop(bvh_.nodes, boxes_, t_, size_, child)) return child;
    }
  }

  /// Continues in the tree of an instance until the stack is at its present size again.
  RELUME_HD_INLINE BvhChild enter(const BvhInstance& instance) {
    world_boxes_ = boxes_;
    if (instance.first_key == kNoKeys) {
      enter_mesh(instance, instance.to_mesh, instance.to_world[3], instance.margin);
    } else {
      Vec3 to_world[4];
      matrix_at(bvh_, instance, ray_.time, to_world);
      const MeshSpace space(to_world);
      enter_mesh(instance, space.to_mesh, to_world[3], space.margin);
    }
    node_ = &instance;
    node_floor_ = size_;
    return instance.root;
  }

  /// Transforms the ray by the columns `m` of an inverse matrix.
  RELUME_HD_INLINE void enter_mesh(const BvhInstance& instance, const Vec3* m, const Vec3& translation,
                                   const Vec3& margin) {
    const auto to_mesh = [m](const Vec3& v) { return m[0] * v.x + m[1] * v.y + m[2] * v.z; };
    boxes_ = BoxRay(to_mesh(ray_.origin - translation), to_mesh(ray_.direction), margin,
                    instance.reach + max_component(abs(ray_.origin)), max_component(abs(ray_.direction)));
  }

  RELUME_HD_INLINE void leave() {
    boxes_ = world_boxes_;
    node_ = nullptr;
  }

  RELUME_HD_INLINE void test(BvhChild leaf) {
    const uint32_t end = leaf.index() + leaf.count();
    for (uint32_t i = leaf.index(); i < end; ++i) {
      const BvhTriangle& triangle = bvh_.triangles[i];
      const TriangleCorners c = placed_corners(bvh_, i, node_, ray_.time);
      Crossing crossing;
      if (!sheared_.crosses(c.p0, c.p1, c.p2, t_, crossing)) continue;
      const uint32_t instance = node_ ? node_->instance : triangle.instance;
      const bool is_nearer =
          crossing.t < t_ || instance < instance_ || (instance == instance_ && triangle.primitive < primitive_);
      if (!is_nearer || !passes_filters(instance, triangle.primitive, c, crossing)) continue;
      t_ = crossing.t;
      instance_ = instance;
      primitive_ = triangle.primitive;
      triangle_ = i;
      hit_node_ = node_;
      if (kAnyHit) return;
    }
  }

  RELUME_HD_INLINE bool passes_filters(uint32_t instance, uint32_t primitive, const TriangleCorners& c,
                                       const Crossing& crossing) const {
    const uint32_t filters = bvh_.filters[instance];
    if ((filters & kCullsBackFaces) != 0 && camera_ != 0) {
      const bool at_back = crossing.at_back != ((filters & kMirrored) != 0);
      if (at_back == (camera_ == kFromCamera)) return false;
    }
    if ((filters & kNeedsOpacity) == 0) return true;
    const TriangleHit on = intersect_triangle(ray_.origin, ray_.direction, c.p0, c.p1, c.p2);
    return stops(opacity_(instance, primitive, on.u, on.v), ray_id_, instance, primitive);
  }

  const BvhView& bvh_;
  const Ray& ray_;
  uint32_t ray_id_;
  unsigned camera_;  ///< kFromCamera, kToCamera or 0
  const Opacity& opacity_;
  Postponed& postponed_;
  ShearedRay sheared_;
  BoxRay boxes_;        ///< in the space of the current tree
  BoxRay world_boxes_;  ///< saved while in an instance
  const BvhInstance* node_ = nullptr;
  uint32_t node_floor_ = 0;  ///< size of the stack when the instance was entered
  uint32_t size_ = 0;

  float t_;  ///< of the nearest hit so far, or the ray's end
  uint32_t instance_ = kNoHit;
  uint32_t primitive_ = kNoHit;
  uint32_t triangle_ = 0;
  const BvhInstance* hit_node_ = nullptr;
};

/// Whether the BVH can answer the ray; others hit nothing.
RELUME_HD inline bool bvh_can_trace(const Ray& ray) {
  return is_traceable(ray) && max_component(abs(ray.direction)) > 0.0f;
}

/// As intersect() and intersect_from_camera() of accel.h. `camera`: kFromCamera or 0.
template <typename Postponed, typename Opacity>
RELUME_HD_INLINE Hit bvh_intersect(const BvhView& bvh, const Ray& ray, uint32_t ray_id, unsigned camera,
                                   const Opacity& opacity) {
  if (!bvh_can_trace(ray)) return {};
  Postponed postponed;
  BvhTraversal<false, Postponed, Opacity> traversal(bvh, ray, ray_id, camera, opacity, postponed);
  traversal.run();
  return traversal.hit();
}

/// As occluded() and occluded_to_camera() of accel.h. `camera`: kToCamera or 0.
template <typename Postponed, typename Opacity>
RELUME_HD_INLINE bool bvh_occluded(const BvhView& bvh, const Ray& ray, uint32_t ray_id, unsigned camera,
                                   const Opacity& opacity) {
  if (!bvh_can_trace(ray)) return false;
  Postponed postponed;
  BvhTraversal<true, Postponed, Opacity> traversal(bvh, ray, ray_id, camera, opacity, postponed);
  traversal.run();
  return traversal.found();
}

}  // namespace relume
