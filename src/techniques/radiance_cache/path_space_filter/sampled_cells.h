// Paths that fill cells, and leave the light beyond their second vertices to reservoirs.
#pragma once

#include "techniques/radiance_cache/path_space_filter/verified_cells.h"
#include "techniques/transport/path/indirect_sample.h"

namespace relume {

/// Whether the light of samples that reservoirs take from paths is what a cache finds from the second vertex on. Such a
/// cache says so by a constant `fills_samples`. The others have cells of primary hits, which lack that light.
template <typename Cache>
inline constexpr bool kFillsSamples = requires {
  requires Cache::fills_samples;
};

namespace sampled_cells {

/// The outputs in order: a cache that finds the light of a sample finishes before the sample is complete.
template <typename Cells, bool fills_samples>
struct KernelOf {
  using Type =
      PathKernel<CachedRecordingOutput, CachedChainOutput, IndirectSampleOutput, Cells, ReservoirScatterOutput>;
};
template <typename Cells>
struct KernelOf<Cells, true> {
  using Type =
      PathKernel<CachedRecordingOutput, CachedChainOutput, Cells, IndirectSampleOutput, ReservoirScatterOutput>;
};

}  // namespace sampled_cells

/// Traces one path per pixel, fills the cells and records samples for reservoirs of indirect light. One kernel serves
/// paths that learn and others, because each is compiled for hosts and devices.
template <typename Cache>
using SampledCellPathsKernel = typename sampled_cells::KernelOf<CellsOutput<Cache>, kFillsSamples<Cache>>::Type;

/// The same with records of first vertices.
template <typename Cache>
using SampledVerifiedCellPathsKernel =
    typename sampled_cells::KernelOf<VerifiedCellsOutput<Cache>, kFillsSamples<Cache>>::Type;

}  // namespace relume
