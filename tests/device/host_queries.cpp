// Ray queries of device code, answered by the host's functions.
#include <cstring>

#include "accel/accel.h"

namespace relume {
namespace {

/// The value of a parameter.
template <typename T>
T value_at(const unsigned char* parameter) {
  T value;
  std::memcpy(&value, parameter, sizeof(T));
  return value;
}

/// Calls a query with the parameters at three addresses.
template <typename Query>
auto answer(const Query& query, const unsigned char* accel, const unsigned char* ray, const unsigned char* ray_id) {
  return query(*value_at<const AccelView*>(accel), *value_at<const Ray*>(ray), value_at<uint32_t>(ray_id));
}

void store_hit(unsigned char* result, const Hit& hit) { std::memcpy(result, &hit, sizeof(hit)); }
void store_flag(unsigned char* result, bool flag) {
  const uint32_t word = flag ? 1 : 0;
  std::memcpy(result, &word, sizeof(word));
}

}  // namespace
}  // namespace relume

extern "C" {

void ptx__ZN6relume9intersectERKNS_9AccelViewERKNS_3RayEj(unsigned char* result, unsigned char* accel,
                                                          unsigned char* ray, unsigned char* ray_id) {
  relume::store_hit(result, relume::answer(relume::intersect, accel, ray, ray_id));
}

void ptx__ZN6relume21intersect_from_cameraERKNS_9AccelViewERKNS_3RayEj(unsigned char* result, unsigned char* accel,
                                                                       unsigned char* ray, unsigned char* ray_id) {
  relume::store_hit(result, relume::answer(relume::intersect_from_camera, accel, ray, ray_id));
}

void ptx__ZN6relume8occludedERKNS_9AccelViewERKNS_3RayEj(unsigned char* result, unsigned char* accel,
                                                         unsigned char* ray, unsigned char* ray_id) {
  relume::store_flag(result, relume::answer(relume::occluded, accel, ray, ray_id));
}

void ptx__ZN6relume18occluded_to_cameraERKNS_9AccelViewERKNS_3RayEj(unsigned char* result, unsigned char* accel,
                                                                    unsigned char* ray, unsigned char* ray_id) {
  relume::store_flag(result, relume::answer(relume::occluded_to_camera, accel, ray, ray_id));
}

}  // extern "C"
