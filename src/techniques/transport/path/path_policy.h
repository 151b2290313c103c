// Policies: operations of caches, histories and learning along a path, beside the estimate.
#pragma once

#include <concepts>

#include "scene/surface_point.h"

namespace relume {

struct PathState;
struct Connection;

/// The default policy does nothing and compiles away. A policy watches if it takes paths and surfaces as constants; it
/// steers if it changes them.
struct NoPolicy {
  /// The emission at the end of the path's ray is added. `lights_know`: next event estimation could have found it, too.
  RELUME_HD void emitted(const PathState&, bool /*lights_know*/) {}
  /// The path has reached a surface whose own emission is already added. False ends the path. A policy that steers may
  /// change the surface's lobes and region, and take radiance and throughput out of the path, here and in scattered().
  RELUME_HD bool arrived(const SurfacePoint&, const PathState&) { return true; }
  /// Next event estimation at the surface; `visible`: the shadow ray was not blocked.
  RELUME_HD void connected(const SurfacePoint&, const PathState&, const Connection&, bool /*visible*/) {}
  /// A direction was sampled; `after`: the path with its new ray.
  RELUME_HD void scattered(const SurfacePoint&, const BsdfSample&, const PathState& /*after*/) {}
  /// The path is complete.
  RELUME_HD void finished(const PathState&) {}
};

/// A policy whose goes_on() is asked after arrived() whether to continue the path. Its arrived() prefetches what
/// goes_on() looks up, and hosts reach the vertices of many paths in between.
template <typename Policy>
concept DecidesLater = requires(Policy& policy, PathState& path) {
  { policy.goes_on(path) } -> std::same_as<bool>;
};

/// Any number of policies of one path. Each operation runs them in their order; one that ends the path ends it for all.
template <typename... Policies>
struct PathPolicies;

template <>
struct PathPolicies<> : NoPolicy {};

template <typename First, typename... Others>
struct PathPolicies<First, Others...> {
  First first;
  PathPolicies<Others...> others;

  RELUME_HD void emitted(const PathState& path, bool lights_know) {
    first.emitted(path, lights_know);
    others.emitted(path, lights_know);
  }
  RELUME_HD bool arrived(SurfacePoint& sp, PathState& path) {
    const bool first_continues = first.arrived(sp, path);
    return others.arrived(sp, path) && first_continues;
  }
  RELUME_HD bool goes_on(PathState& path) requires(DecidesLater<First> || DecidesLater<PathPolicies<Others...>>) {
    bool continues = true;
    if constexpr (DecidesLater<First>) continues = first.goes_on(path);
    if constexpr (DecidesLater<PathPolicies<Others...>>) continues = others.goes_on(path) && continues;
    return continues;
  }
  RELUME_HD void connected(const SurfacePoint& sp, const PathState& path, const Connection& c, bool visible) {
    first.connected(sp, path, c, visible);
    others.connected(sp, path, c, visible);
  }
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample& s, PathState& after) {
    first.scattered(sp, s, after);
    others.scattered(sp, s, after);
  }
  RELUME_HD void finished(PathState& path) {
    first.finished(path);
    others.finished(path);
  }
};

}  // namespace relume
