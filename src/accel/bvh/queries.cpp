#include "accel/bvh/queries.h"

#include "accel/bvh/postponed_children.h"
#include "accel/bvh/traverse.h"
#include "accel/host_accel.h"

namespace relume {
namespace {

/// Calls the opacity function of the scene.
struct SceneOpacity {
  HostAccel host;

  float operator()(uint32_t instance, uint32_t primitive, float u, float v) const {
    const OpacityFunction& opacity = host.data->opacity;
    return opacity.function(opacity.context, instance, primitive, u, v);
  }
};

}  // namespace

Hit nearest_in_bvh(const AccelView& accel, const Ray& ray, uint32_t ray_id, unsigned camera) {
  return bvh_intersect<PostponedChildren>(accel.bvh, ray, ray_id, camera, SceneOpacity{accel.host});
}

bool blocked_in_bvh(const AccelView& accel, const Ray& ray, uint32_t ray_id, unsigned camera) {
  return bvh_occluded<PostponedChildren>(accel.bvh, ray, ray_id, camera, SceneOpacity{accel.host});
}

}  // namespace relume
