// The light selection "mcls" as a pass.
#pragma once

#include "frame/pass.h"
#include "techniques/light_sampling/light_selection/light_selector.h"
#include "techniques/light_sampling/light_selection/settings.h"
#include "techniques/light_sampling/light_tree/build_light_tree.h"
#include "techniques/light_sampling/markov_chain_lights/light_chain_recorder.h"
#include "techniques/light_sampling/markov_chain_lights/settings.h"
#include "techniques/spatial/markov_grid/markov_cells.h"

namespace relume {

/// Rebuilds the light tree when lights have changed, and gives the states that paths of the last frame recorded to
/// their cells.
class MarkovChainLightsPass final : public Pass {
 public:
  MarkovChainLightsPass(const MarkovChainLightsSettings& settings, const LightSelectionSettings& selection,
                        Memory& memory)
      : settings_(settings), selection_(selection), tree_(memory), cells_("mcls", memory) {
    selector_.kind = LightSelectorKind::markov_chains;
  }

  void configure(const MarkovChainLightsSettings& settings) { settings_ = settings; }
  void configure(const LightSelectionSettings& settings) { selection_ = settings; }
  PassDeclaration declaration() const override { return {.name = "mcls", .stage = Stage::prepare}; }
  bool run(const FrameContext& frame) override;
  void abandon() override { cells_.abandon(); }
  /// Chains move in each frame: an epoch of several would need a copy of the table.
  uint32_t longest_epoch() const override { return 1; }
  size_t memory_bytes() const override { return tree_.memory_bytes() + cells_.memory_bytes(); }
  std::vector<PassStatistic> statistics() const override { return cells_.statistics(); }
  void save(std::ostream& out) const override { cells_.save(out); }
  void load(std::istream& in) override { cells_.load(in); }

  /// Here and below valid after the first run().
  const LightSelector& selector() const { return selector_; }
  /// The records of this frame's paths.
  const LightChainRecording& recording() const { return recording_; }

 private:
  MarkovChainLightsSettings settings_;
  LightSelectionSettings selection_;
  LightSelector selector_;
  LightTreeArrays tree_;
  bool built_ = false;
  MarkovCells<LightState> cells_;
  LightChainRecording recording_;
};

}  // namespace relume
