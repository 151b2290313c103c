#include "embree_recorder.h"

#include <atomic>
#include <bit>

// Query options are the last argument in Embree 4, and precede the ray in Embree 3.
#if RTC_VERSION_MAJOR >= 4
using IntersectOptions = RTCIntersectArguments;
using OccludedOptions = RTCOccludedArguments;
#define RELUME_ARGUMENTS(Query, Options) RTCScene scene, Query *query, Options *options
#define RELUME_PASS_ON scene, query, options
#else
using IntersectOptions = RTCIntersectContext;
using OccludedOptions = RTCIntersectContext;
#define RELUME_ARGUMENTS(Query, Options) RTCScene scene, Options *options, Query *query
#define RELUME_PASS_ON scene, options, query
#endif

// Linker names: callers of F reach __wrap_F; __real_F is F itself.
// NOLINTBEGIN(bugprone-reserved-identifier,readability-identifier-naming)
extern "C" {
void __real_rtcIntersect1(RELUME_ARGUMENTS(RTCRayHit, IntersectOptions));
void __real_rtcOccluded1(RELUME_ARGUMENTS(RTCRay, OccludedOptions));
void __real_rtcIntersect16(const int* valid, RELUME_ARGUMENTS(RTCRayHit16, IntersectOptions));
void __real_rtcOccluded16(const int* valid, RELUME_ARGUMENTS(RTCRay16, OccludedOptions));
}

namespace relume {
namespace {

QueryLog* current_log = nullptr;
uint64_t found_sum = 0;
std::atomic<RTCScene> last_scene{nullptr};

/// Writes only if the scene changed, so that the frame's threads share the cache line.
void note_scene(RTCScene scene) {
  if (last_scene.load(std::memory_order_relaxed) != scene) last_scene.store(scene, std::memory_order_relaxed);
}

uint64_t bits(float value) { return std::bit_cast<uint32_t>(value); }

/// Query result as a number.
uint64_t found(const RTCRayHit& query) {
  return query.hit.geomID == RTC_INVALID_GEOMETRY_ID ? 0 : bits(query.ray.tfar) + query.hit.primID;
}

uint64_t found(const RTCRay& query) { return query.tfar < 0.0f ? 1 : 0; }

uint64_t found(const int* valid, const RTCRayHit16& query) {
  uint64_t sum = 0;
  for (int i = 0; i < kPacketSize; ++i) {
    if (valid[i] != 0 && query.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID)
      sum += bits(query.ray.tfar[i]) + query.hit.primID[i];
  }
  return sum;
}

uint64_t found(const int* valid, const RTCRay16& query) {
  uint64_t sum = 0;
  for (int i = 0; i < kPacketSize; ++i) sum += valid[i] != 0 && query.tfar[i] < 0.0f ? 1 : 0;
  return sum;
}

}  // namespace

void QueryLog::add(const RTCRay& ray, bool occlusion) {
  queries_.push_back({static_cast<uint32_t>(singles_.size()), false, occlusion});
  singles_.push_back(ray);
  ++(occlusion ? shadow_rays : nearest_rays);
}

void QueryLog::add(const RTCRay16& rays, const int* valid, bool occlusion) {
  queries_.push_back({static_cast<uint32_t>(packets_.size()), true, occlusion});
  Packet& packet = packets_.emplace_back();
  packet.rays = rays;
  for (int i = 0; i < kPacketSize; ++i) {
    packet.valid[i] = valid[i];
    if (valid[i] != 0) ++(occlusion ? shadow_rays : nearest_rays);
  }
}

uint64_t QueryLog::replay(RTCScene scene, size_t begin, size_t end) const {
  uint64_t sum = 0;
  for (size_t i = begin; i < end; ++i) {
    const Query& query = queries_[i];
    if (!query.packet && !query.occlusion) {
      RTCRayHit hit;
      hit.ray = singles_[query.index];
      hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
      embree::intersect1(scene, hit, nullptr);
      sum += found(hit);
    } else if (!query.packet) {
      RTCRay ray = singles_[query.index];
      embree::occluded1(scene, ray, nullptr);
      sum += found(ray);
    } else if (!query.occlusion) {
      const Packet& packet = packets_[query.index];
      RTCRayHit16 hits;
      hits.ray = packet.rays;
      for (int k = 0; k < kPacketSize; ++k) hits.hit.geomID[k] = hits.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
      embree::intersect16(packet.valid, scene, hits, nullptr);
      sum += found(packet.valid, hits);
    } else {
      RTCRay16 rays = packets_[query.index].rays;
      embree::occluded16(packets_[query.index].valid, scene, rays, nullptr);
      sum += found(packets_[query.index].valid, rays);
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

void __wrap_rtcIntersect1(RELUME_ARGUMENTS(RTCRayHit, IntersectOptions)) {
  note_scene(scene);
  if (current_log) current_log->add(query->ray, false);
  __real_rtcIntersect1(RELUME_PASS_ON);
  if (current_log) found_sum += found(*query);
}

void __wrap_rtcOccluded1(RELUME_ARGUMENTS(RTCRay, OccludedOptions)) {
  note_scene(scene);
  if (current_log) current_log->add(*query, true);
  __real_rtcOccluded1(RELUME_PASS_ON);
  if (current_log) found_sum += found(*query);
}

void __wrap_rtcIntersect16(const int* valid, RELUME_ARGUMENTS(RTCRayHit16, IntersectOptions)) {
  note_scene(scene);
  if (current_log) current_log->add(query->ray, valid, false);
  __real_rtcIntersect16(valid, RELUME_PASS_ON);
  if (current_log) found_sum += found(valid, *query);
}

void __wrap_rtcOccluded16(const int* valid, RELUME_ARGUMENTS(RTCRay16, OccludedOptions)) {
  note_scene(scene);
  if (current_log) current_log->add(*query, valid, true);
  __real_rtcOccluded16(valid, RELUME_PASS_ON);
  if (current_log) found_sum += found(valid, *query);
}
}
// NOLINTEND(bugprone-reserved-identifier,readability-identifier-naming)

}  // namespace relume
