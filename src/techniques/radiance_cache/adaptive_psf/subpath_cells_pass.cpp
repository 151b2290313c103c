#include "techniques/radiance_cache/adaptive_psf/subpath_cells_pass.h"

#include "techniques/radiance_cache/adaptive_psf/subpath_cells.h"

namespace relume {
namespace {

PassDeclaration with_cells(PassDeclaration declaration, const CellPathUsers& users) {
  declaration.owns.push_back(filtered_pixels_buffer());
  if (users.reservoirs) declaration.owns.push_back(scatter_chances_buffer());
  return declaration;
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

PassDeclaration BdptCellsPass::declaration() const { return with_cells(BdptPass::declaration(), cells_.cells.users()); }

bool BdptCellsPass::trace(const FrameContext& frame, const BdptKernel& kernel) {
  return trace_into(frame, kernel, cells_.output(frame));
}

PassDeclaration VcmCellsPass::declaration() const { return with_cells(VcmPass::declaration(), cells_.cells.users()); }

bool VcmCellsPass::trace(const FrameContext& frame, const BdptKernel& kernel) {
  return trace_into(frame, kernel, cells_.output(frame));
}

}  // namespace relume
