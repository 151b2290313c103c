#include "techniques/radiance_cache/path_graphs/path_graphs_pass.h"

#include "techniques/radiance_cache/path_graphs/path_graphs.h"

namespace relume {

PassDeclaration PathGraphPass::declaration() const { return cell_paths_declaration(cells_); }

PathGraphContext make_path_graph(const PathGraphSettings& settings, const FilterContext& filter) {
  PathGraphContext graph;
  graph.filter = filter;
  graph.primary.enabled = false;
  graph.variance_constant = settings.variance_constant;
  graph.measure = settings.variance;
  graph.feed = settings.feed;
  graph.guards = settings.guards;
  graph.deep_coarsening = static_cast<uint16_t>(settings.deep_coarsening);
  return graph;
}

bool PathGraphPass::run(const FrameContext& frame) {
  PathGraphContext graph = make_path_graph(settings_, cells_.filter());
  graph.primary = make_adaptive_psf(primary_, BlendFunction::zero);
  graph.primary.enabled = adapts_primary_;
  return trace_into_cells(source_, frame, cells_, graph, records_);
}

}  // namespace relume
