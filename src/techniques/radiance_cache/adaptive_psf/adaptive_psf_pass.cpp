#include "techniques/radiance_cache/adaptive_psf/adaptive_psf_pass.h"

#include "techniques/radiance_cache/adaptive_psf/adaptive_psf.h"

namespace relume {

PassDeclaration AdaptivePsfPass::declaration() const { return cell_paths_declaration(); }

bool AdaptivePsfPass::run(const FrameContext& frame) {
  return trace_into_cells(source_, frame, AdaptiveFilterContext{cells_.filter(), make_adaptive_psf(settings_)});
}

}  // namespace relume
