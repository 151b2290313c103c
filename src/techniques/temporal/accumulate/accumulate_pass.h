// The histories "none" and "accumulate" as a pass.
#pragma once

#include "frame/pass.h"
#include "frame/primitives/primitive.h"
#include "techniques/temporal/accumulate/image_error.h"

namespace relume {

/// Moments accumulated besides the mean and the variance of luminance.
struct AccumulatedParts {
  bool m2_rgb = false;       ///< sum of squared distances of all channels from their mean
  bool splat_image = false;  ///< a separate image of the splats of light paths
  bool specular = false;     ///< a separate mean of the specular part
  bool caustics = false;     ///< separate moments of the caustic layer
  bool cells = false;        ///< a separate mean of the part from cells of a cache; excludes `specular`
};

/// The only writer of kMoments.
class AccumulatePass final : public Pass {
 public:
  /// `invalidated_by`: changes that clear the mean. `keep`: false shows only the latest sample.
  AccumulatePass(Change invalidated_by, bool keep, const AccumulatedParts& parts)
      : invalidated_by_(invalidated_by), keep_(keep), parts_(parts) {}

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  size_t memory_bytes() const override { return scratch_.memory_bytes(); }

 private:
  Change invalidated_by_;
  bool keep_;
  AccumulatedParts parts_;
  PrimitiveScratch scratch_;
};

/// Root of the mean variance of the pixels' means, over the image's mean luminance. 0 for a black image, infinite if a
/// pixel has fewer than two samples, or fewer than the correlated frames.
double relative_error(const PrimitiveLaunch& at, const ImageErrors& image);

}  // namespace relume
