// The slot "light selection" as a pass: keeps what the chosen selector needs up to date with the lights.
#pragma once

#include <vector>

#include "pipeline/pass.h"
#include "techniques/light_selector.h"

namespace relume {

class LightSelectionPass final : public Pass {
 public:
  explicit LightSelectionPass(LightSelectorKind kind) { selector_.kind = kind; }

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

  /// What estimators sample with; valid from the first run() on.
  const LightSelector& selector() const { return selector_; }

 private:
  LightSelector selector_;
  std::vector<AliasEntry> power_entries_;
  bool built_ = false;
};

}  // namespace relume
