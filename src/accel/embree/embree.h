// Common interface to queries of Embree 3 and 4, which differ in their header and in how a query receives its options.
#pragma once

#if __has_include(<embree4/rtcore.h>)
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace relume::embree {

/// Options of a query beyond its rays.
struct QueryOptions {
  bool coherent = false;                ///< whether the rays have similar origins and directions
  RTCFilterFunctionN filter = nullptr;  ///< called for hits on geometries with enable_query_filter()
};

#if RTC_VERSION_MAJOR >= 4

/// Flag of scenes whose hits query filters may receive. Every scene below the queried one needs it.
inline constexpr RTCSceneFlags kQueryFilterFlag = RTC_SCENE_FLAG_FILTER_FUNCTION_IN_ARGUMENTS;

/// Lets query filters receive the hits on a geometry, which must be committed afterwards.
inline void enable_query_filter(RTCGeometry geometry, bool enabled) {
  rtcSetGeometryEnableFilterFunctionFromArguments(geometry, enabled);
}

template <typename Arguments>
void apply(const QueryOptions& options, Arguments& arguments) {
  if (options.coherent) arguments.flags = RTC_RAY_QUERY_FLAG_COHERENT;
  arguments.filter = options.filter;
}

inline RTCIntersectArguments intersect_arguments(const QueryOptions& options) {
  RTCIntersectArguments arguments;
  rtcInitIntersectArguments(&arguments);
  apply(options, arguments);
  return arguments;
}

inline RTCOccludedArguments occluded_arguments(const QueryOptions& options) {
  RTCOccludedArguments arguments;
  rtcInitOccludedArguments(&arguments);
  apply(options, arguments);
  return arguments;
}

inline void intersect1(RTCScene scene, RTCRayHit& query, const QueryOptions& options) {
  RTCIntersectArguments arguments = intersect_arguments(options);
  rtcIntersect1(scene, &query, &arguments);
}

inline void occluded1(RTCScene scene, RTCRay& query, const QueryOptions& options) {
  RTCOccludedArguments arguments = occluded_arguments(options);
  rtcOccluded1(scene, &query, &arguments);
}

inline void intersect16(const int* valid, RTCScene scene, RTCRayHit16& query, const QueryOptions& options) {
  RTCIntersectArguments arguments = intersect_arguments(options);
  rtcIntersect16(valid, scene, &query, &arguments);
}

inline void occluded16(const int* valid, RTCScene scene, RTCRay16& query, const QueryOptions& options) {
  RTCOccludedArguments arguments = occluded_arguments(options);
  rtcOccluded16(valid, scene, &query, &arguments);
}

#else

/// Flag of scenes whose hits query filters may receive. Every scene below the queried one needs it.
inline constexpr RTCSceneFlags kQueryFilterFlag = RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION;

/// No effect: Embree 3 passes all geometries of a scene to query filters.
inline void enable_query_filter(RTCGeometry, bool) {}

inline RTCIntersectContext make_context(const QueryOptions& options) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  if (options.coherent) context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  context.filter = options.filter;
  return context;
}

inline void intersect1(RTCScene scene, RTCRayHit& query, const QueryOptions& options) {
  RTCIntersectContext context = make_context(options);
  rtcIntersect1(scene, &context, &query);
}

inline void occluded1(RTCScene scene, RTCRay& query, const QueryOptions& options) {
  RTCIntersectContext context = make_context(options);
  rtcOccluded1(scene, &context, &query);
}

inline void intersect16(const int* valid, RTCScene scene, RTCRayHit16& query, const QueryOptions& options) {
  RTCIntersectContext context = make_context(options);
  rtcIntersect16(valid, scene, &context, &query);
}

inline void occluded16(const int* valid, RTCScene scene, RTCRay16& query, const QueryOptions& options) {
  RTCIntersectContext context = make_context(options);
  rtcOccluded16(valid, scene, &context, &query);
}

#endif

/// Whether queries of the scene may have a filter. Embree 3 terminates the process if the flag is missing.
inline bool takes_query_filter(RTCScene scene) { return (rtcGetSceneFlags(scene) & kQueryFilterFlag) != 0; }

}  // namespace relume::embree
