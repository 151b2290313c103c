#include "techniques/radiance_cache/path_graphs/path_graphs_pass.h"

#include "techniques/radiance_cache/path_graphs/path_graphs.h"

namespace relume {

PassDeclaration PathGraphPass::declaration() const { return cell_paths_declaration(cells_); }

bool PathGraphPass::run(const FrameContext& frame) {
  PathGraphContext graph;
  graph.filter = cells_.filter();
  graph.primary = make_adaptive_psf(primary_, BlendFunction::zero);
  graph.primary.enabled = adapts_primary_;
  graph.variance_constant = settings_.variance_constant;
  graph.measure = settings_.variance;
  graph.feed = settings_.feed;
  graph.guards = settings_.guards;
  graph.deep_coarsening = static_cast<uint16_t>(settings_.deep_coarsening);
  return trace_into_cells(source_, frame, cells_, graph, records_);
}

}  // namespace relume
