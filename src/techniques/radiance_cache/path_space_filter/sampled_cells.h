// Paths that fill cells, and leave the light from the second vertex on to reservoirs.
#pragma once

#include <type_traits>
#include <utility>

#include "techniques/radiance_cache/path_space_filter/verified_cells.h"
#include "techniques/transport/path/indirect_sample.h"

namespace relume {

/// Whether the cache contributes to the light of reservoir samples, from the second vertex on. Such caches define
/// `fills_samples`. Other caches have cells at primary hits, without that light.
template <typename Cache>
inline constexpr bool kFillsSamples = requires {
  requires Cache::fills_samples;
};

/// Calls `trace` with the outputs `cells` and `samples` in their order: a cache that finds the light of a sample
/// finishes before the sample is complete.
template <typename Cache, typename Cells, typename Trace>
auto trace_in_order(const Cells& cells, const IndirectSampleOutput& samples, const Trace& trace) {
  if constexpr (kFillsSamples<Cache>) {
    return trace(cells, samples);
  } else {
    return trace(samples, cells);
  }
}

namespace sampled_cells {

/// Gives the kernel of two outputs in their order.
struct KernelType {
  template <typename First, typename Second>
  auto operator()(const First&, const Second&) const {
    return std::type_identity<
        PathKernel<CachedRecordingOutput, CachedChainOutput, First, Second, ReservoirScatterOutput>>();
  }
};

template <typename Cache, typename Cells>
using KernelOf = typename decltype(trace_in_order<Cache>(
    std::declval<const Cells&>(), std::declval<const IndirectSampleOutput&>(), KernelType()))::type;

}  // namespace sampled_cells

/// Traces one path per pixel, fills the cells and records samples for reservoirs of indirect light. One kernel serves
/// paths that learn and others, because each is compiled for hosts and devices.
template <typename Cache>
using SampledCellPathsKernel = sampled_cells::KernelOf<Cache, CellsOutput<Cache>>;

/// The same with records of first vertices.
template <typename Cache>
using SampledVerifiedCellPathsKernel = sampled_cells::KernelOf<Cache, VerifiedCellsOutput<Cache>>;

}  // namespace relume
