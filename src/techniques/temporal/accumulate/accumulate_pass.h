// The histories "none" and "accumulate" as a pass.
#pragma once

#include "frame/pass.h"

namespace relume {

/// Moments accumulated besides the mean and the variance of luminance.
struct AccumulatedParts {
  bool m2_rgb = false;       ///< sum of squared distances of all channels from their mean
  bool splat_image = false;  ///< a separate image of the splats of light paths
  bool specular = false;     ///< a separate mean of the specular part
};

/// The only writer of kMoments.
class AccumulatePass final : public Pass {
 public:
  /// `invalidated_by`: changes that clear the mean. `keep`: false shows only the latest sample.
  AccumulatePass(Change invalidated_by, bool keep, const AccumulatedParts& parts)
      : invalidated_by_(invalidated_by), keep_(keep), parts_(parts) {}

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  Change invalidated_by_;
  bool keep_;
  AccumulatedParts parts_;
};

/// Buffers of SplatImage, from the present stage.
struct SplatImageBuffers {
  View<const float> m2;
  View<const float> weight;
  View<const uint32_t> frames;
};

/// Root of the mean variance of the pixels' means, over the image's mean luminance. 0 for a black image, infinite if a
/// pixel has fewer than two samples.
double relative_error(const MomentsView& moments, const SplatImageBuffers& splats = {});

}  // namespace relume
