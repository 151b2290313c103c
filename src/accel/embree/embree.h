// Queries of Embree 3 and 4 under one name each. The two differ in their header and in how a query is told its options.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace relume::embree {

#if RTC_VERSION_MAJOR >= 4

inline void intersect1(RTCScene scene, RTCRayHit& query) { rtcIntersect1(scene, &query); }
inline void occluded1(RTCScene scene, RTCRay& query) { rtcOccluded1(scene, &query); }
inline void occluded8(const int* valid, RTCScene scene, RTCRay8& query) { rtcOccluded8(valid, scene, &query); }

/// `coherent`: the rays begin close to each other and have similar directions.
inline void intersect8(const int* valid, RTCScene scene, RTCRayHit8& query, bool coherent) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  if (coherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  rtcIntersect8(valid, scene, &query, &arguments);
}

#else

inline RTCIntersectContext make_context() {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  return context;
}

inline void intersect1(RTCScene scene, RTCRayHit& query) {
  RTCIntersectContext context = make_context();
  rtcIntersect1(scene, &context, &query);
}

inline void occluded1(RTCScene scene, RTCRay& query) {
  RTCIntersectContext context = make_context();
  rtcOccluded1(scene, &context, &query);
}

inline void occluded8(const int* valid, RTCScene scene, RTCRay8& query) {
  RTCIntersectContext context = make_context();
  rtcOccluded8(valid, scene, &context, &query);
}

/// `coherent`: the rays begin close to each other and have similar directions.
inline void intersect8(const int* valid, RTCScene scene, RTCRayHit8& query, bool coherent) {
  RTCIntersectContext context = make_context();
  if (coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  rtcIntersect8(valid, scene, &context, &query);
}

#endif

}  // namespace relume::embree
