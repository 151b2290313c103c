// The choice "ris" of the slot reuse as a pass.
#pragma once

#include <cstdint>

#include "frame/pass.h"
#include "techniques/reuse/reservoir/settings.h"
#include "techniques/transport/path/path_pass.h"

namespace relume {

struct CandidateStage;
struct ReservoirImage;

/// Destinations of the chosen lights, from which light selection learns; nullptr: none. They are those of the paths.
struct CandidateRecords {
  const PathRecording* samples = nullptr;
  const LightChainRecording* chains = nullptr;
};

/// The paths whose directions at primary hits are candidates.
enum class CandidatePaths : uint8_t {
  traced_paths,             ///< trace_paths(): pixels have a direction at the rate PathSettings::indirect_rate
  subpaths,                 ///< camera subpaths (techniques/transport/bdpt): every pixel has one
  one_wavelength_subpaths,  ///< the same, all with the wavelength frame_wavelength()
};

/// The first stage of reservoirs in this frame.
CandidateStage candidate_stage(const RisSettings& settings, const PathSource& source, const CandidateRecords& records,
                               CandidatePaths paths, const FrameContext& frame);
/// The planes to which reservoirs add light. The pass must access the buffers of reservoir_reads_if_any(),
/// reservoir_writes() and reservoir_writes_if_any().
ReservoirImage reservoir_image(const FrameContext& frame);

/// Buffers of other passes that every pass of reservoirs accesses.
std::vector<BufferId> reservoir_reads();
std::vector<BufferId> reservoir_reads_if_any();
std::vector<BufferId> reservoir_writes();
std::vector<BufferId> reservoir_writes_if_any();

/// Adds direct light at primary hits to the radiance of paths that leave it out and record kFirstScatters.
class RisPass final : public Pass {
 public:
  RisPass(const RisSettings& settings, const PathSource& source, const CandidateRecords& records, CandidatePaths paths)
      : settings_(settings), source_(source), records_(records), paths_(paths) {}

  void configure(const RisSettings& settings) { settings_ = settings; }
  void configure(const PathSettings& path) { source_.settings = path; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;

 private:
  RisSettings settings_;
  PathSource source_;
  CandidateRecords records_;
  CandidatePaths paths_;
};

}  // namespace relume
