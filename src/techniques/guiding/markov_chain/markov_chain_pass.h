// The direction sampling "mcpg" as a pass.
#pragma once

#include "frame/pass.h"
#include "techniques/guiding/direction_sampling/direction_sampler.h"
#include "techniques/guiding/markov_chain/guide_recorder.h"
#include "techniques/guiding/markov_chain/settings.h"
#include "techniques/spatial/markov_grid/markov_cells.h"

namespace relume {

/// Gives the states that paths of the last frame recorded to their cells.
class MarkovChainPass final : public Pass {
 public:
  MarkovChainPass(const MarkovChainSettings& settings, Memory& memory) : settings_(settings), cells_("mcpg", memory) {
    directions_.kind = DirectionSamplerKind::markov_chains;
  }

  void configure(const MarkovChainSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override { return {.name = "mcpg", .stage = Stage::prepare}; }
  bool run(const FrameContext& frame) override;
  void abandon() override { cells_.abandon(); }
  /// Chains move in each frame: an epoch of several would need a copy of the table.
  uint32_t longest_epoch() const override { return 1; }
  size_t memory_bytes() const override { return cells_.memory_bytes(); }
  std::vector<PassStatistic> statistics() const override { return cells_.statistics(); }
  void save(std::ostream& out) const override { cells_.save(out); }
  void load(std::istream& in) override { cells_.load(in); }

  /// The sampler for estimators, here and below valid after the first run().
  const DirectionSampler& directions() const { return directions_; }
  /// The records of this frame's paths.
  const GuideRecording& recording() const { return recording_; }

 private:
  MarkovChainSettings settings_;
  MarkovCells<GuideState> cells_;
  DirectionSampler directions_;
  GuideRecording recording_;
};

}  // namespace relume
