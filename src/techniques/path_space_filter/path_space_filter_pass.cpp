#include "techniques/path_space_filter/path_space_filter_pass.h"

namespace relume {

PassDeclaration PathSpaceFilterPass::declaration() const { return cell_paths_declaration(); }

bool PathSpaceFilterPass::run(const FrameContext& frame) {
  PathSpaceFilterKernel kernel;
  kernel.context = make_path_context(source_, frame);
  kernel.cache = cells_.filter();
  return trace_into_cells(frame, kernel);
}

}  // namespace relume
