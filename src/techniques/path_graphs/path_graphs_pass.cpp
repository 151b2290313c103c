#include "techniques/path_graphs/path_graphs_pass.h"

#include "techniques/path_graphs/path_graphs.h"

namespace relume {

PassDeclaration PathGraphPass::declaration() const { return cell_paths_declaration(); }

bool PathGraphPass::run(const FrameContext& frame) {
  PathGraphKernel kernel;
  kernel.context = make_path_context(source_, frame);
  kernel.graph.filter = cells_.filter();
  kernel.graph.primary = make_adaptive_psf(primary_ ? *primary_ : AdaptivePsfSettings{}, BlendFunction::zero);
  kernel.graph.primary.enabled = primary_ != nullptr;
  kernel.graph.variance_constant = settings_.variance_constant;
  kernel.graph.measure = settings_.variance;
  kernel.graph.feed = settings_.feed;
  kernel.graph.deep_coarsening = static_cast<uint16_t>(settings_.deep_coarsening);
  return trace_into_cells(frame, kernel);
}

}  // namespace relume
