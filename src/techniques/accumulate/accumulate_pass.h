// The histories "none" and "accumulate" as a pass.
#pragma once

#include "pipeline/pass.h"

namespace relume {

class AccumulatePass final : public Pass {
 public:
  /// `invalidated_by`: changes after which the mean starts anew. `keep`: false shows this frame alone.
  AccumulatePass(Change invalidated_by, bool keep) : invalidated_by_(invalidated_by), keep_(keep) {}

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  Change invalidated_by_;
  bool keep_;
};

}  // namespace relume
