// Kernel of all passes that trace one path per pixel.
#pragma once

#include "techniques/transport/path/path_batch.h"
#include "techniques/transport/path/walk.h"

namespace relume {

/// The outputs of a kernel, each with the policy that fills it. An output has
///   Policy                          its path policy (path_policy.h)
///   policy(index, x, y, pixel)      returns the policy of a pixel's path
///   finish(pixel, policy, path)     stores the results of a complete path
///   leave_out(pixel)                stores the results of a pixel without a path
template <typename... Outputs>
struct PathOutputs;

template <>
struct PathOutputs<> {
  RELUME_HD PathPolicies<> policies(const SampleIndex&, uint32_t, uint32_t, uint32_t) const { return {}; }
  RELUME_HD void finish(uint32_t, const PathPolicies<>&, const PathState&) const {}
  RELUME_HD void leave_out(uint32_t) const {}
};

template <typename First, typename... Others>
struct PathOutputs<First, Others...> {
  using Policies = PathPolicies<typename First::Policy, typename Others::Policy...>;

  First first;
  PathOutputs<Others...> others;

  RELUME_HD Policies policies(const SampleIndex& index, uint32_t x, uint32_t y, uint32_t pixel) const {
    return {first.policy(index, x, y, pixel), others.policies(index, x, y, pixel)};
  }
  RELUME_HD void finish(uint32_t pixel, Policies& policies, const PathState& path) const {
    first.finish(pixel, policies.first, path);
    others.finish(pixel, policies.others, path);
  }
  RELUME_HD void leave_out(uint32_t pixel) const {
    first.leave_out(pixel);
    others.leave_out(pixel);
  }
};

template <typename First, typename... Others>
RELUME_HD inline PathOutputs<First, Others...> path_outputs(const First& first, const Others&... others) {
  if constexpr (sizeof...(Others) == 0) {
    return {first, {}};
  } else {
    return {first, path_outputs(others...)};
  }
}

/// Traces one path per pixel from the primary hits.
template <typename... Outputs>
struct PathKernel {
  PathContext context;
  SampleIndex index;
  View<const Hit> hits;
  View<const uint32_t> allocation;  ///< paths of the pixel, 0 or 1; empty: 1
  View<uint32_t> rays;              ///< of this sample
  uint32_t width = 0;
  PathOutputs<Outputs...> outputs;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    if (!wanted(pixel)) return leave_out(pixel);
    Sampler sampler = index.sampler(x, y);
    auto policies = this->policies(x, y);
    const PathState path = trace_path(context, x, y, sampler, hits[pixel], policies);
    finish(pixel, policies, path);
  }

  /// Host: traces several paths of the tile side by side.
  void operator()(const Tile& tile) const { path_batch::trace_tile(*this, tile, nullptr); }

  RELUME_HD bool wanted(uint32_t pixel) const { return allocation.empty() || allocation[pixel] != 0; }
  RELUME_HD void leave_out(uint32_t pixel) const {
    outputs.leave_out(pixel);
    rays[pixel] = 0;
  }
  RELUME_HD auto policies(uint32_t x, uint32_t y) const { return outputs.policies(index, x, y, y * width + x); }
  template <typename Policies>
  RELUME_HD void finish(uint32_t pixel, Policies& policies, const PathState& path) const {
    outputs.finish(pixel, policies, path);
    rays[pixel] = path.rays;
  }
};

/// Output of the radiance of each path.
struct RadianceOutput {
  using Policy = NoPolicy;

  View<Rgb> radiance;  ///< of this sample; may be not finite

  RELUME_HD NoPolicy policy(const SampleIndex&, uint32_t, uint32_t, uint32_t) const { return {}; }
  RELUME_HD void finish(uint32_t pixel, const NoPolicy&, const PathState& path) const {
    radiance[pixel] = path.radiance;
  }
  RELUME_HD void leave_out(uint32_t pixel) const { radiance[pixel] = Rgb(0); }
};

}  // namespace relume
