#include "accel/bvh/queries.h"

#include "accel/accel_structure.h"
#include "accel/bvh/traverse.h"

namespace relume {
namespace {

/// Calls the opacity function of the scene.
struct SceneOpacity {
  const OpacityFunction& opacity;

  float operator()(uint32_t instance, uint32_t primitive, float u, float v) const {
    return opacity.function(opacity.context, instance, primitive, u, v);
  }
};

}  // namespace

Hit nearest_in_bvh(const BvhView& bvh, const Ray& ray, uint32_t ray_id, unsigned camera) {
  return bvh_intersect(bvh, ray, ray_id, camera, SceneOpacity{*bvh.opacity});
}

bool blocked_in_bvh(const BvhView& bvh, const Ray& ray, uint32_t ray_id, unsigned camera) {
  return bvh_occluded(bvh, ray, ray_id, camera, SceneOpacity{*bvh.opacity});
}

}  // namespace relume
