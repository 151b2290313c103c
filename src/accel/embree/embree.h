// Common interface to queries of Embree 3 and 4, which differ in their header and in how a query receives its options.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace relume::embree {

// Queries take a filter, called for hits on geometries with enable_query_filter(); nullptr: none. They never set the
// coherence flag: with it, Embree tests the rays of a packet together and finds other hits at edges.

#if RTC_VERSION_MAJOR >= 4

/// Flag of scenes whose hits query filters may receive. Every scene below the queried one needs it.
inline constexpr RTCSceneFlags kQueryFilterFlag = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;

/// Lets query filters receive the hits on a geometry, which must be committed afterwards.
inline void enable_query_filter(RTCGeometry geometry, bool enabled) {
  rtcSetGeometryEnableFilterFunctionFromArguments(geometry, enabled);
}

inline RTCIntersectArguments intersect_arguments(RTCFilterFunctionN filter) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  arguments.filter = filter;
  return arguments;
}

inline RTCOccludedArguments occluded_arguments(RTCFilterFunctionN filter) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  arguments.filter = filter;
  return arguments;
}

inline void intersect1(RTCScene scene, RTCRayHit& query, RTCFilterFunctionN filter) {
  RTCIntersectArguments arguments = intersect_arguments(filter);
  rtcIntersect1(scene, &query, &arguments);
}

inline void occluded1(RTCScene scene, RTCRay& query, RTCFilterFunctionN filter) {
  RTCOccludedArguments arguments = occluded_arguments(filter);
  rtcOccluded1(scene, &query, &arguments);
}

inline void intersect16(const int* valid, RTCScene scene, RTCRayHit16& query, RTCFilterFunctionN filter) {
  RTCIntersectArguments arguments = intersect_arguments(filter);
  rtcIntersect16(valid, scene, &query, &arguments);
}

inline void occluded16(const int* valid, RTCScene scene, RTCRay16& query, RTCFilterFunctionN filter) {
  RTCOccludedArguments arguments = occluded_arguments(filter);
  rtcOccluded16(valid, scene, &query, &arguments);
}

#else

/// Flag of scenes whose hits query filters may receive. Every scene below the queried one needs it.
inline constexpr RTCSceneFlags kQueryFilterFlag = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;

/// No effect: Embree 3 passes all geometries of a scene to query filters.
inline void enable_query_filter(RTCGeometry, bool) {}

inline RTCIntersectContext make_context(RTCFilterFunctionN filter) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.filter = filter;
  return context;
}

inline void intersect1(RTCScene scene, RTCRayHit& query, RTCFilterFunctionN filter) {
  RTCIntersectContext context = make_context(filter);
  rtcIntersect1(scene, &context, &query);
}

inline void occluded1(RTCScene scene, RTCRay& query, RTCFilterFunctionN filter) {
  RTCIntersectContext context = make_context(filter);
  rtcOccluded1(scene, &context, &query);
}

inline void intersect16(const int* valid, RTCScene scene, RTCRayHit16& query, RTCFilterFunctionN filter) {
  RTCIntersectContext context = make_context(filter);
  rtcIntersect16(valid, scene, &context, &query);
}

inline void occluded16(const int* valid, RTCScene scene, RTCRay16& query, RTCFilterFunctionN filter) {
  RTCIntersectContext context = make_context(filter);
  rtcOccluded16(valid, scene, &context, &query);
}

#endif

/// Whether queries of the scene may have a filter. Embree 3 terminates the process if the flag is missing.
inline bool takes_query_filter(RTCScene scene) { return (rtcGetSceneFlags(scene) & kQueryFilterFlag) != 0; }

}  // namespace relume::embree
