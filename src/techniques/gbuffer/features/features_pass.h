// The features as a pass; part of a frame if a denoiser is.
#pragma once

#include "frame/pass.h"
#include "techniques/transport/path/settings.h"

namespace relume {

class FeaturesPass final : public Pass {
 public:
  /// `path`: features follow specular paths for as many bounces as the estimator does. `mirrors`: whether the estimator
  /// shows what is seen in mirrors and through smooth glass. `split`: also find the reflections that specular lobes
  /// show, for denoisers that keep diffuse and specular light apart.
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

/// Mirrors and interfaces that features follow in frames of an estimator with `max_bounces`; `mirrors`: see above.
uint32_t followed_steps(int max_bounces, bool mirrors);

}  // namespace relume
