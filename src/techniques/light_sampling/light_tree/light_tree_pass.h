// The pass for the light selection "light-tree".
#pragma once

#include "frame/pass.h"
#include "techniques/light_sampling/light_selection/light_selector.h"
#include "techniques/light_sampling/light_selection/settings.h"
#include "techniques/light_sampling/light_tree/build_light_tree.h"

namespace relume {

/// Rebuilds the tree when lights have changed.
class LightTreePass final : public Pass {
 public:
  LightTreePass(const LightSelectionSettings& settings, Memory& memory) : settings_(settings), tree_(memory) {
    selector_.kind = LightSelectorKind::light_tree;
  }

  void configure(const LightSelectionSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override { return {.name = "light-tree", .stage = Stage::prepare}; }
  bool run(const FrameContext& frame) override;
  size_t memory_bytes() const override { return tree_.memory_bytes(); }

  /// Valid after the first run().
  const LightSelector& selector() const { return selector_; }

 private:
  LightSelectionSettings settings_;
  LightSelector selector_;
  LightTreeArrays tree_;
  bool built_ = false;
};

}  // namespace relume
