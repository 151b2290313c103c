// The pass for the light selections "uniform" and "power".
#pragma once

#include <vector>

#include "core/array.h"
#include "frame/pass.h"
#include "techniques/light_sampling/light_selection/light_selector.h"
#include "techniques/light_sampling/light_selection/settings.h"

namespace relume {

class LightSelectionPass final : public Pass {
 public:
  LightSelectionPass(const LightSelectionSettings& settings, LightSelectorKind kind, Memory& memory)
      : settings_(settings), power_(memory) {
    selector_.kind = kind;
  }

  void configure(const LightSelectionSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  size_t memory_bytes() const override { return power_.memory_bytes(); }

  /// Valid after the first run().
  const LightSelector& selector() const { return selector_; }

 private:
  LightSelectionSettings settings_;
  LightSelector selector_;
  Array<AliasEntry> power_;
  bool built_ = false;
};

}  // namespace relume
