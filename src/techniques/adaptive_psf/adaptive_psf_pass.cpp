#include "techniques/adaptive_psf/adaptive_psf_pass.h"

#include "techniques/adaptive_psf/adaptive_psf.h"

namespace relume {

PassDeclaration AdaptivePsfPass::declaration() const { return cell_paths_declaration(); }

bool AdaptivePsfPass::run(const FrameContext& frame) {
  AdaptivePsfKernel kernel;
  kernel.context = make_path_context(source_, frame);
  kernel.cache = {cells_.filter(), make_adaptive_psf(settings_)};
  return trace_into_cells(frame, kernel);
}

}  // namespace relume
