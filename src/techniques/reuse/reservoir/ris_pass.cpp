#include "techniques/reuse/reservoir/ris_pass.h"

#include "techniques/reuse/reservoir/reuse_pass.h"
#include "techniques/reuse/reservoir/ris.h"
#include "techniques/transport/path/frame_wavelength.h"
#include "techniques/transport/path/scatter_chances.h"

namespace relume {

CandidateStage candidate_stage(const RisSettings& settings, const PathSource& source, const CandidateRecords& records,
                               CandidatePaths paths, const FrameContext& frame) {
  CandidateStage stage;
  stage.context = make_path_context(source, frame);
  if (paths != CandidatePaths::traced_paths) stage.context.indirect = {};
  // The densities of candidates must be those at the wavelength of the paths.
  if (paths == CandidatePaths::one_wavelength_subpaths && frame.scene.disperses)
    stage.wavelength_nm = frame_wavelength(frame.index);
  stage.index = frame.index;
  stage.hits = frame.read(kPrimaryHits);
  stage.scatters = frame.read(kFirstScatters);
  stage.chances = frame.read(kScatterChances);
  stage.first_vertices = frame.write(kFirstVertices);
  if (records.samples) stage.recording = *records.samples;
  if (records.chains) stage.chains = *records.chains;
  stage.light_candidates = static_cast<uint32_t>(settings.candidates);
  stage.width = frame.width();
  return stage;
}

ReservoirImage reservoir_image(const FrameContext& frame) { return {reuse_image(frame), frame.write(kFirstVertices)}; }

std::vector<BufferId> reservoir_reads() { return {kPrimaryHits, kFirstScatters}; }
std::vector<BufferId> reservoir_reads_if_any() { return {kAllocation, kScatterChances}; }
std::vector<BufferId> reservoir_writes() { return {kRadiance, kRays}; }
std::vector<BufferId> reservoir_writes_if_any() { return {kRadianceSpecular, kFirstVertices}; }

PassDeclaration RisPass::declaration() const {
  return {.name = "ris",
          .stage = Stage::resolve,
          .reads = reservoir_reads(),
          .writes = reservoir_writes(),
          .reads_if_any = reservoir_reads_if_any(),
          .writes_if_any = reservoir_writes_if_any(),
          .only_sampled_pixels = true};
}

bool RisPass::run(const FrameContext& frame) {
  const RisKernel kernel{candidate_stage(settings_, source_, records_, paths_, frame), reservoir_image(frame)};
  return frame.launch_or_stop("ris", kernel);
}

}  // namespace relume
