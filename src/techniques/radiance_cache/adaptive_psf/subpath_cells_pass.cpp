#include "techniques/radiance_cache/adaptive_psf/subpath_cells_pass.h"

#include "techniques/radiance_cache/adaptive_psf/first_light_of_cells.h"
#include "techniques/radiance_cache/adaptive_psf/sampled_subpath_cells.h"
#include "techniques/radiance_cache/adaptive_psf/subpath_cells.h"

namespace relume {
namespace {

PassDeclaration with_cells(PassDeclaration declaration, const CellPathUsers& users) {
  declaration.owns.push_back(filtered_pixels_buffer());
  if (users.history) declaration.owns.push_back(cells_at_hit_buffer());
  if (users.reservoirs) declaration.owns.push_back(scatter_chances_buffer());
  return declaration;
}

/// Calls `trace` with the output for the frame's kernel.
template <typename Trace>
bool trace_into_output(const CellsOfSubpaths& cells, const FrameContext& frame, const Trace& trace) {
  const SubpathCells output = cells.output(frame);
  if (!cells.cells.users().indirect) return trace(output);
  return trace(SampledSubpathCells{output, {frame.write(kIndirectSamples)}});
}

}  // namespace

SubpathCells CellsOfSubpaths::output(const FrameContext& frame) const {
  SubpathCells output;
  output.cache.filter = cells.filter();
  output.cache.filter.by_prefix = true;
  if (adapts) output.cache.adaptive = make_adaptive_psf(settings);
  output.cache.adaptive.enabled = adapts;
  output.pixels = frame.write(kFilteredPixels);
  output.radiance = frame.write(kRadiance);
  if (cells.users().reservoirs) output.scatter_chances = frame.write(kScatterChances);
  return output;
}

bool CellsOfSubpaths::record_first_vertices(const FrameContext& frame, const BdptKernel& kernel) const {
  const FirstLightOfCellsKernel record{.context = kernel.context,
                                       .index = kernel.index,
                                       .hits = kernel.hits,
                                       .allocation = kernel.allocation,
                                       .splats = frame.read(kRadiance),
                                       .pixels = frame.read(kFilteredPixels),
                                       .cells_at_hit = frame.write(kCellsAtHit)};
  return frame.launch_or_stop("first-vertices", record);
}

PassDeclaration BdptCellsPass::declaration() const { return with_cells(BdptPass::declaration(), cells_.cells.users()); }

bool BdptCellsPass::trace(const FrameContext& frame, const BdptKernel& kernel) {
  return trace_into_output(cells_, frame, [&](const auto& output) { return trace_into(frame, kernel, output); });
}

PassDeclaration VcmCellsPass::declaration() const { return with_cells(VcmPass::declaration(), cells_.cells.users()); }

bool VcmCellsPass::trace(const FrameContext& frame, const BdptKernel& kernel) {
  return trace_into_output(cells_, frame, [&](const auto& output) { return trace_into(frame, kernel, output); });
}

}  // namespace relume
