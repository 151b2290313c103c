// Writes features, for denoisers and for backward reprojection of split light.
#pragma once

#include "frame/pass.h"
#include "techniques/transport/path/settings.h"

namespace relume {

class FeaturesPass final : public Pass {
 public:
  /// `path`: limits followed steps to the estimator's bounces. `mirrors`: whether the estimator shows images in mirrors
  /// and smooth glass. `split`: also traces reflections, to split diffuse and specular light.
  FeaturesPass(const PathSettings& path, bool mirrors, bool split)
      : max_bounces_(path.max_bounces), mirrors_(mirrors), split_(split) {}
  void configure(const PathSettings& path) { max_bounces_ = path.max_bounces; }

  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  int max_bounces_;
  bool mirrors_;
  bool split_;
};

/// Maximum number of mirrors and interfaces followed, for an estimator with `max_bounces`; `mirrors` as above.
uint32_t followed_steps(int max_bounces, bool mirrors);

}  // namespace relume
