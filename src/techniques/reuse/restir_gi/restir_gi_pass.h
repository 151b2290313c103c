// The choice "restir-gi" of the slot reuse as a pass.
#pragma once

#include "frame/pass.h"
#include "techniques/reuse/reservoir/ris_pass.h"
#include "techniques/reuse/restir_gi/settings.h"
#include "techniques/transport/path/path_pass.h"

namespace relume {

/// Adds indirect light at primary hits to the radiance of paths that leave it out (PathRecords::indirect_samples).
class RestirGiPass final : public Pass {
 public:
  /// `paths`: those that find the samples. `repeats`: whether their random numbers and structures can be repeated.
  /// `false` with techniques that learn, with caches that the paths of samples read, and with light subpaths.
  RestirGiPass(const RestirGiSettings& settings, const PathSource& source, CandidatePaths paths, bool repeats)
      : settings_(settings), source_(source), paths_(paths), repeats_(repeats) {}

  void configure(const RestirGiSettings& settings) { settings_ = settings; }
  void configure(const PathSettings& path) { source_.settings = path; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  bool keeps_to_pixels() const override { return false; }
  uint32_t correlated_frames() const override { return frames_correlated_by(settings_.cap); }

 private:
  bool validates() const;
  // These return false if a stop was requested first.
  bool validate(const FrameContext& frame) const;
  bool reuse_history(const FrameContext& frame) const;
  bool reuse_neighbours(const FrameContext& frame) const;

  RestirGiSettings settings_;
  PathSource source_;
  CandidatePaths paths_;
  bool repeats_;
};

}  // namespace relume
