#include "techniques/radiance_cache/adaptive_psf/adaptive_psf_pass.h"

#include "techniques/radiance_cache/adaptive_psf/adaptive_psf.h"

namespace relume {

PassDeclaration AdaptivePsfPass::declaration() const { return cell_paths_declaration(cells_); }

bool AdaptivePsfPass::run(const FrameContext& frame) {
  const AdaptiveFilterContext filter{cells_.filter(), make_adaptive_psf(settings_)};
  return trace_into_cells(source_, frame, cells_, filter, records_);
}

}  // namespace relume
