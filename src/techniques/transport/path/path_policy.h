// Policies: hooks that the path tracer calls along a path, for caches, histories and learning.
#pragma once

#include <concepts>

#include "scene/surface_point.h"

namespace relume {

struct PathState;
struct Connection;

/// The default policy does nothing and compiles away. An observing policy takes paths and surfaces by const reference;
/// a modifying policy takes them by reference and changes them.
struct NoPolicy {
  /// Called at each surface that the path's ray reaches, before the surface's emission is added.
  RELUME_HD void hit_surface(const SurfacePoint&, const PathState&) {}
  /// Called after the emission at the end of the path's ray was added. `covered_by_nee`: next event estimation could
  /// also have sampled it.
  RELUME_HD void emitted(const PathState&, bool /*covered_by_nee*/) {}
  /// Called at a surface whose own emission is already added. Returning false ends the path. A modifying policy may
  /// change the lobes and region of the surface. It may also remove radiance and throughput from the path, here and in
  /// scattered().
  RELUME_HD bool arrived(const SurfacePoint&, const PathState&) { return true; }
  /// Called after next event estimation at the surface; `visible`: the shadow ray was not blocked.
  RELUME_HD void connected(const SurfacePoint&, const PathState&, const Connection&, bool /*visible*/) {}
  /// Called after a direction was sampled; `after`: the path with its new ray.
  RELUME_HD void scattered(const SurfacePoint&, const BsdfSample&, const PathState& /*after*/) {}
  /// Called when the path is complete.
  RELUME_HD void finished(const PathState&) {}
};

/// A policy that decides in goes_on(), not in arrived(), whether the path continues. Its arrived() prefetches the data
/// that goes_on() reads; between the two calls, CPUs process the arrivals of other paths to hide the latency.
template <typename Policy>
concept DecidesLater = requires(Policy& policy, PathState& path) {
  { policy.goes_on(path) } -> std::same_as<bool>;
};

/// Combines any number of policies for one path. Each hook calls them in the order of the template arguments. If one
/// policy ends the path, it ends for all.
template <typename... Policies>
struct PathPolicies;

template <>
struct PathPolicies<> : NoPolicy {};

template <typename First, typename... Others>
struct PathPolicies<First, Others...> {
  First first;
  PathPolicies<Others...> others;

  RELUME_HD void hit_surface(const SurfacePoint& sp, const PathState& path) {
    first.hit_surface(sp, path);
    others.hit_surface(sp, path);
  }
  RELUME_HD void emitted(const PathState& path, bool covered_by_nee) {
    first.emitted(path, covered_by_nee);
    others.emitted(path, covered_by_nee);
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
