// Writes features, for denoisers and for backward reprojection of split light.
#pragma once

#include <memory>

#include "frame/pass.h"
#include "techniques/gbuffer/primary_hits/first_surfaces.h"
#include "techniques/transport/path/settings.h"

namespace relume {

class FeaturesPass final : public Pass {
 public:
  /// `path`: limits followed steps to the estimator's bounces. `mirrors`: whether the estimator shows images in mirrors
  /// and smooth glass. `split`: also traces reflections, to split diffuse and specular light.
  FeaturesPass(const PathSettings& path, bool mirrors, bool split);
  ~FeaturesPass() override;
  void configure(const PathSettings& path) { max_bounces_ = path.max_bounces; }

  /// Returns the receiver of the surfaces that path tracing evaluates. From now on, this pass leaves the features to
  /// it, except with dispersion or while a hook observes the passes. No pass before path tracing may read features.
  const FirstSurfaces& from_paths();

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  class FromPaths;

  int max_bounces_;
  bool mirrors_;
  bool split_;
  std::unique_ptr<FromPaths> from_paths_;  ///< nullptr: this pass evaluates the surfaces
};

/// Maximum number of mirrors and interfaces followed, for an estimator with `max_bounces`; `mirrors` as above.
uint32_t followed_steps(int max_bounces, bool mirrors);

}  // namespace relume
