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

/// Root of the mean variance of the pixels' means over the picture's mean luminance, from AccumulateKernel's buffers. 0
/// for a black picture, infinite where a pixel has fewer than two samples.
double relative_error(View<const Rgb> mean, View<const float> m2, View<const uint32_t> samples);

}  // namespace relume
