// The pass for the light selections "uniform" and "power".
#pragma once

#include <vector>

#include "frame/pass.h"
#include "techniques/light_sampling/light_selection/light_selector.h"
#include "techniques/light_sampling/light_selection/settings.h"

namespace relume {

class LightSelectionPass final : public Pass {
 public:
  LightSelectionPass(const LightSelectionSettings& settings, LightSelectorKind kind) : settings_(settings) {
    selector_.kind = kind;
  }

  void configure(const LightSelectionSettings& settings) { settings_ = settings; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  size_t memory_bytes() const override { return power_.capacity() * sizeof(AliasEntry); }

  /// Valid after the first run().
  const LightSelector& selector() const { return selector_; }

 private:
  LightSelectionSettings settings_;
  LightSelector selector_;
  std::vector<AliasEntry> power_;
  bool built_ = false;
};

}  // namespace relume
