// The light selection "light-tree" as a pass.
#pragma once

#include "frame/pass.h"
#include "techniques/light_sampling/light_selection/light_selector.h"
#include "techniques/light_sampling/light_selection/settings.h"
#include "techniques/light_sampling/light_tree/build_light_tree.h"

namespace relume {

/// Rebuilds the tree in every frame in which lights differ.
class LightTreePass final : public Pass {
 public:
  explicit LightTreePass(const LightSelectionSettings& settings) : settings_(settings) {
    selector_.kind = LightSelectorKind::light_tree;
  }

  void configure(const LightSelectionSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override { return {.name = "light-tree", .stage = Stage::prepare}; }
  bool run(const FrameContext& frame) override;
  size_t memory_bytes() const override { return data_.memory_bytes(); }

  /// What estimators sample with; valid from the first run() on.
  const LightSelector& selector() const { return selector_; }

 private:
  LightSelectionSettings settings_;
  LightSelector selector_;
  LightTreeData data_;
  bool built_ = false;
};

}  // namespace relume
