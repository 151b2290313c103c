// Policies: hooks that the path tracer calls along a path, for caches, histories and learning.
#pragma once

#include <concepts>
#include <type_traits>

#include "lights/light.h"
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
  /// Called when next event estimation has picked a light at the surface, which may have no contribution there.
  /// Policies may lack this hook.
  RELUME_HD void light_picked(const SurfacePoint&, const PathState&, LightId) {}
  /// Called after next event estimation at the surface; `visible`: the shadow ray was not blocked.
  RELUME_HD void connected(const SurfacePoint&, const PathState&, const Connection&, bool /*visible*/) {}
  /// Called after a direction was sampled; `after`: the path with its new ray.
  RELUME_HD void scattered(const SurfacePoint&, const BsdfSample&, const PathState& /*after*/) {}
  /// Called when the path is complete.
  RELUME_HD void finished(const PathState&) {}

  // Events. A modifying policy reports them to the policies before it in the list, which its arrived(), goes_on() and
  // scattered() take as a last argument.

  /// The radiance of the path, `found`, was set to zero. Radiance and throughput now count `unit` times in the image.
  RELUME_HD void rebased(const Rgb& /*found*/, const Rgb& /*unit*/) {}
  /// A cell replaces the light that the current vertex reflects, except from its delta lobes. In the image, it counts
  /// `radiance`.
  RELUME_HD void ended_in_cell(const Rgb& /*radiance*/) {}
  /// The path continues from the current vertex. `probability`: of this, from the camera on.
  RELUME_HD void survived(float /*probability*/) {}
  /// A random number ends the path at the current vertex, whatever light the rest would find.
  RELUME_HD void culled() {}
};

/// Whether policies precede the one that reports events to `Earlier`.
template <typename Earlier>
inline constexpr bool kHasEarlier = !std::is_same_v<Earlier, NoPolicy>;

/// Reports events to `first` and `last`.
template <typename First, typename Last>
struct PathEvents {
  First& first;
  Last& last;

  RELUME_HD void rebased(const Rgb& found, const Rgb& unit) {
    first.rebased(found, unit);
    last.rebased(found, unit);
  }
  RELUME_HD void ended_in_cell(const Rgb& radiance) {
    first.ended_in_cell(radiance);
    last.ended_in_cell(radiance);
  }
  RELUME_HD void survived(float probability) {
    first.survived(probability);
    last.survived(probability);
  }
  RELUME_HD void culled() {
    first.culled();
    last.culled();
  }
};

/// A policy that decides in goes_on(), not in arrived(), whether the path continues. Its arrived() prefetches the data
/// that goes_on() reads; between the two calls, CPUs process the arrivals of other paths to hide the latency.
template <typename Policy>
concept DecidesLater = requires(Policy& policy, PathState& path) {
  { policy.goes_on(path) } -> std::same_as<bool>;
}
|| requires(Policy& policy, PathState& path, NoPolicy& earlier) {
  { policy.goes_on(path, earlier) } -> std::same_as<bool>;
};

/// Whether a path with this policy chooses among PathContext::light_candidates lights at its primary hit. A policy says
/// so by a constant `resamples_lights`; the kernels of others lack the code.
template <typename Policy>
inline constexpr bool kResamplesLights = requires {
  requires Policy::resamples_lights;
};

namespace path_policy {

// Calls of one policy, which reports events to `earlier` if it takes them.

template <typename Policy, typename Earlier>
RELUME_HD inline bool arrived(Policy& policy, SurfacePoint& sp, PathState& path, Earlier& earlier) {
  if constexpr (requires { policy.arrived(sp, path, earlier); }) {
    return policy.arrived(sp, path, earlier);
  } else {
    return policy.arrived(sp, path);
  }
}

template <typename Policy, typename Earlier>
RELUME_HD inline bool goes_on(Policy& policy, PathState& path, Earlier& earlier) {
  if constexpr (requires { policy.goes_on(path, earlier); }) {
    return policy.goes_on(path, earlier);
  } else if constexpr (DecidesLater<Policy>) {
    return policy.goes_on(path);
  } else {
    return true;
  }
}

template <typename Policy, typename Earlier>
RELUME_HD inline void scattered(Policy& policy, const SurfacePoint& sp, const BsdfSample& s, PathState& after,
                                Earlier& earlier) {
  if constexpr (requires { policy.scattered(sp, s, after, earlier); }) {
    policy.scattered(sp, s, after, earlier);
  } else {
    policy.scattered(sp, s, after);
  }
}

template <typename Policy>
RELUME_HD inline void light_picked(Policy& policy, const SurfacePoint& sp, const PathState& path, LightId light) {
  if constexpr (requires { policy.light_picked(sp, path, light); }) policy.light_picked(sp, path, light);
}

}  // namespace path_policy

/// Combines any number of policies for one path. Each hook calls them in the order of the template arguments. If one
/// policy ends the path, it ends for all. Events of a policy reach those before it.
template <typename... Policies>
struct PathPolicies;

template <>
struct PathPolicies<> : NoPolicy {};

template <typename First, typename... Others>
struct PathPolicies<First, Others...> {
  static constexpr bool resamples_lights = kResamplesLights<First> || kResamplesLights<PathPolicies<Others...>>;

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
    NoPolicy none;
    return arrived(sp, path, none);
  }
  template <typename Earlier>
  RELUME_HD bool arrived(SurfacePoint& sp, PathState& path, Earlier& earlier) {
    const bool first_continues = path_policy::arrived(first, sp, path, earlier);
    PathEvents<Earlier, First> events{earlier, first};
    return path_policy::arrived(others, sp, path, events) && first_continues;
  }
  RELUME_HD bool goes_on(PathState& path) requires(DecidesLater<First> || DecidesLater<PathPolicies<Others...>>) {
    NoPolicy none;
    return goes_on(path, none);
  }
  template <typename Earlier>
  RELUME_HD bool goes_on(PathState& path,
                         Earlier& earlier) requires(DecidesLater<First> || DecidesLater<PathPolicies<Others...>>) {
    const bool first_continues = path_policy::goes_on(first, path, earlier);
    PathEvents<Earlier, First> events{earlier, first};
    return path_policy::goes_on(others, path, events) && first_continues;
  }
  RELUME_HD void light_picked(const SurfacePoint& sp, const PathState& path, LightId light) {
    path_policy::light_picked(first, sp, path, light);
    path_policy::light_picked(others, sp, path, light);
  }
  RELUME_HD void connected(const SurfacePoint& sp, const PathState& path, const Connection& c, bool visible) {
    first.connected(sp, path, c, visible);
    others.connected(sp, path, c, visible);
  }
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample& s, PathState& after) {
    NoPolicy none;
    scattered(sp, s, after, none);
  }
  template <typename Earlier>
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample& s, PathState& after, Earlier& earlier) {
    path_policy::scattered(first, sp, s, after, earlier);
    PathEvents<Earlier, First> events{earlier, first};
    path_policy::scattered(others, sp, s, after, events);
  }
  RELUME_HD void finished(PathState& path) {
    first.finished(path);
    others.finished(path);
  }
};

}  // namespace relume
