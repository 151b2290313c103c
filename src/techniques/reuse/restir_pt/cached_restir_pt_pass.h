// The choice "restir-pt" of the slot reuse beside caches with cells behind primary hits, as passes.
#pragma once

#include "techniques/radiance_cache/path_graphs/settings.h"
#include "techniques/radiance_cache/path_space_filter/cells_pass.h"
#include "techniques/radiance_cache/sharc/settings.h"
#include "techniques/reuse/restir_pt/restir_pt_pass.h"

namespace relume {

/// Reservoirs of paths that end in the cells of "sharc" behind their joints.
class SharcRestirPtPass final : public RestirPtPass {
 public:
  SharcRestirPtPass(const RestirPtSettings& settings, const SharcSettings& sharc, const PathSource& source,
                    const PathLearning& learning, const CellsPass& cells)
      : RestirPtPass(settings, source, learning), sharc_(sharc), cells_(cells) {}

  using RestirPtPass::configure;
  void configure(const SharcSettings& sharc) { sharc_ = sharc; }

 protected:
  bool trace_candidates(const FrameContext& frame) const override;
  bool uses_cells() const override { return true; }

 private:
  SharcSettings sharc_;
  const CellsPass& cells_;
};

/// Reservoirs of paths that fill and read the cells of path graphs behind their joints.
class GraphRestirPtPass final : public RestirPtPass {
 public:
  GraphRestirPtPass(const RestirPtSettings& settings, const PathGraphSettings& graphs, const PathSource& source,
                    const PathLearning& learning, const CellsPass& cells)
      : RestirPtPass(settings, source, learning), graphs_(graphs), cells_(cells) {}

  using RestirPtPass::configure;
  void configure(const PathGraphSettings& graphs) { graphs_ = graphs; }

 protected:
  bool trace_candidates(const FrameContext& frame) const override;
  bool uses_cells() const override { return true; }

 private:
  PathGraphSettings graphs_;
  const CellsPass& cells_;
};

}  // namespace relume
