#include "techniques/radiance_cache/path_space_filter/path_space_filter_pass.h"

namespace relume {

PassDeclaration PathSpaceFilterPass::declaration() const { return cell_paths_declaration(cells_); }

bool PathSpaceFilterPass::run(const FrameContext& frame) {
  return trace_into_cells(source_, frame, cells_, cells_.filter(), records_);
}

}  // namespace relume
