#include "embree_recorder.h"

#include <atomic>
#include <bit>

// The linker's names: __wrap_F is what callers of F reach, __real_F is F itself.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" {
void __real_rtcIntersect1(RTCScene scene, RTCIntersectContext* context, RTCRayHit* query);
void __real_rtcOccluded1(RTCScene scene, RTCIntersectContext* context, RTCRay* query);
void __real_rtcIntersect8(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit8* query);
void __real_rtcOccluded8(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRay8* query);
}

namespace relume {
namespace {

QueryLog* current_log = nullptr;
uint64_t found_sum = 0;
std::atomic<RTCScene> last_scene{nullptr};

/// Writes only what is new, so that the threads of a frame share the cache line.
void note_scene(RTCScene scene) {
  if (last_scene.load(std::memory_order_relaxed) != scene) last_scene.store(scene, std::memory_order_relaxed);
}

uint64_t bits(float value) { return std::bit_cast<uint32_t>(value); }

/// Runs the query and says what it found as a number.
uint64_t answer(RTCScene scene, RTCIntersectContext* context, RTCRayHit* query) {
  __real_rtcIntersect1(scene, context, query);
  return query->hit.geomID == RTC_INVALID_GEOMETRY_ID ? 0 : bits(query->ray.tfar) + query->hit.primID;
}

uint64_t answer(RTCScene scene, RTCIntersectContext* context, RTCRay* query) {
  __real_rtcOccluded1(scene, context, query);
  return query->tfar < 0.0f ? 1 : 0;
}

uint64_t answer(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit8* query) {
  __real_rtcIntersect8(valid, scene, context, query);
  uint64_t sum = 0;
  for (int i = 0; i < 8; ++i) {
    if (valid[i] != 0 && query->hit.geomID[i] != RTC_INVALID_GEOMETRY_ID)
      sum += bits(query->ray.tfar[i]) + query->hit.primID[i];
  }
  return sum;
}

uint64_t answer(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRay8* query) {
  __real_rtcOccluded8(valid, scene, context, query);
  uint64_t sum = 0;
  for (int i = 0; i < 8; ++i) sum += valid[i] != 0 && query->tfar[i] < 0.0f ? 1 : 0;
  return sum;
}

RTCIntersectContext make_context(RTCIntersectContextFlags flags) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = flags;
  return context;
}

}  // namespace

void QueryLog::add(const RTCRay& ray, const RTCIntersectContext& context, bool occlusion) {
  queries_.push_back({static_cast<uint32_t>(singles_.size()), false, occlusion, context.flags});
  singles_.push_back(ray);
  ++(occlusion ? shadow_rays : path_rays);
}

void QueryLog::add(const RTCRay8& rays, const int* valid, const RTCIntersectContext& context, bool occlusion) {
  queries_.push_back({static_cast<uint32_t>(packets_.size()), true, occlusion, context.flags});
  Packet& packet = packets_.emplace_back();
  packet.rays = rays;
  for (int i = 0; i < 8; ++i) {
    packet.valid[i] = valid[i];
    if (valid[i] != 0) ++(occlusion ? shadow_rays : camera_rays);
  }
}

uint64_t QueryLog::replay(RTCScene scene, size_t begin, size_t end) const {
  uint64_t sum = 0;
  for (size_t i = begin; i < end; ++i) {
    const Query& query = queries_[i];
    RTCIntersectContext context = make_context(query.flags);
    if (!query.packet && !query.occlusion) {
      RTCRayHit hit;
      hit.ray = singles_[query.index];
      hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      sum += answer(scene, &context, &hit);
    } else if (!query.packet) {
      RTCRay ray = singles_[query.index];
      sum += answer(scene, &context, &ray);
    } else if (!query.occlusion) {
      const Packet& packet = packets_[query.index];
      RTCRayHit8 hits;
      hits.ray = packet.rays;
      for (int k = 0; k < 8; ++k) hits.hit.geomID[k] = hits.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
      sum += answer(packet.valid, scene, &context, &hits);
    } else {
      RTCRay8 rays = packets_[query.index].rays;
      sum += answer(packets_[query.index].valid, scene, &context, &rays);
    }
  }
  return sum;
}

void record_queries(QueryLog* log) {
  current_log = log;
  found_sum = 0;
}

RTCScene last_queried_scene() { return last_scene; }
uint64_t recorded_sum() { return found_sum; }

extern "C" {

void __wrap_rtcIntersect1(RTCScene scene, RTCIntersectContext* context, RTCRayHit* query) {
  note_scene(scene);
  if (!current_log) return __real_rtcIntersect1(scene, context, query);
  current_log->add(query->ray, *context, false);
  found_sum += answer(scene, context, query);
}

void __wrap_rtcOccluded1(RTCScene scene, RTCIntersectContext* context, RTCRay* query) {
  note_scene(scene);
  if (!current_log) return __real_rtcOccluded1(scene, context, query);
  current_log->add(*query, *context, true);
  found_sum += answer(scene, context, query);
}

void __wrap_rtcIntersect8(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRayHit8* query) {
  note_scene(scene);
  if (!current_log) return __real_rtcIntersect8(valid, scene, context, query);
  current_log->add(query->ray, valid, *context, false);
  found_sum += answer(valid, scene, context, query);
}

void __wrap_rtcOccluded8(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRay8* query) {
  note_scene(scene);
  if (!current_log) return __real_rtcOccluded8(valid, scene, context, query);
  current_log->add(*query, valid, *context, true);
  found_sum += answer(valid, scene, context, query);
}
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

}  // namespace relume
