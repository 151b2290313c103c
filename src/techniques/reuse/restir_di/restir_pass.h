// The choice "restir-di" of the slot reuse as a pass.
#pragma once

#include "frame/pass.h"
#include "techniques/reuse/reservoir/ris_pass.h"
#include "techniques/reuse/reservoir/settings.h"
#include "techniques/reuse/restir_di/settings.h"
#include "techniques/transport/path/path_pass.h"

namespace relume {

/// Adds direct light at primary hits to the radiance of paths that leave it out and record kFirstScatters.
class RestirPass final : public Pass {
 public:
  RestirPass(const RisSettings& candidates, const RestirSettings& settings, const PathSource& source,
             const CandidateRecords& records, CandidatePaths paths)
      : candidates_(candidates), settings_(settings), source_(source), records_(records), paths_(paths) {}

  void configure(const RisSettings& candidates) { candidates_ = candidates; }
  void configure(const RestirSettings& settings) { settings_ = settings; }
  void configure(const PathSettings& path) { source_.settings = path; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  bool keeps_to_pixels() const override { return false; }
  uint32_t correlated_frames() const override { return frames_correlated_by(settings_.cap); }

 private:
  RisSettings candidates_;
  RestirSettings settings_;
  PathSource source_;
  CandidateRecords records_;
  CandidatePaths paths_;
};

}  // namespace relume
