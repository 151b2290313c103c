// The histories "none" and "accumulate" as a pass.
#pragma once

#include "frame/pass.h"

namespace relume {

class AccumulatePass final : public Pass {
 public:
  /// `invalidated_by`: changes that clear the mean. `keep`: false shows this frame alone. `film`: light paths have a
  /// film of their own.
  AccumulatePass(Change invalidated_by, bool keep, bool film)
      : invalidated_by_(invalidated_by), keep_(keep), film_(film) {}

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  Change invalidated_by_;
  bool keep_;
  bool film_;
};

/// The present stage's buffers of light paths, for LightFilm.
struct LightFilmBuffers {
  View<const float> m2;
  View<const float> weight;
  View<const uint32_t> frames;
};

/// Root of the mean variance of the pixels' means over the picture's mean luminance, from AccumulateKernel's buffers. 0
/// for a black picture, infinite where a pixel has fewer than two samples.
double relative_error(View<const Rgb> mean, View<const float> m2, View<const uint32_t> samples,
                      const LightFilmBuffers& film = {});

}  // namespace relume
