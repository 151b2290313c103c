#include "techniques/temporal/reprojection/specular_history_pass.h"

#include "techniques/temporal/reprojection/backward_buffers.h"
#include "techniques/temporal/reprojection/specular_history.h"

namespace relume {
namespace {

constexpr BufferKey<Rgb> kMeanSpecular{"mean-specular"};
constexpr BufferKey<uint32_t> kSamplesSpecular{"samples-specular"};

constexpr Change kEnds = Change::materials | Change::settings;
constexpr Change kMovesScene = Change::geometry | Change::lights;

bool moves(const FrameContext& frame) {
  return frame.number > 0 && !includes(frame.changes, kEnds) && includes(frame.changes, Change::camera | kMovesScene);
}

}  // namespace

PassDeclaration DetachSpecularPass::declaration() const {
  const auto kept = [](const BufferId& id, const char* help) {
    return BufferDescription{
        .id = id, .help = help, .persistent = true, .reset = kEnds, .display = BufferDisplay::value};
  };
  return {.name = "reproject",
          .stage = Stage::history,
          .owns = {kept(kMeanSpecular, "specular part of mean"), kept(kSamplesSpecular, "samples in mean-specular")},
          .reads = {kReflection.motion, kReflection.previous, kReflection.position, kReflection.normal,
                    kReflection.depth, kReflection.surface},
          .writes = {kMean}};
}

bool DetachSpecularPass::run(const FrameContext& frame) {
  if (!moves(frame)) return true;
  DetachSpecularKernel kernel;
  kernel.reflections = backward_reprojection(frame, kReflection);
  kernel.specular = frame.write(kMeanSpecular);
  kernel.samples = frame.write(kSamplesSpecular);
  specular_before_.assign(kernel.specular.begin(), kernel.specular.end());
  samples_before_.assign(kernel.samples.begin(), kernel.samples.end());
  kernel.specular_before = view_of(specular_before_);
  kernel.samples_before = view_of(samples_before_);
  kernel.mean = frame.write(kMean);
  kernel.max_samples = static_cast<uint32_t>(includes(frame.changes, kMovesScene) ? settings_.max_samples_changed
                                                                                  : settings_.max_samples);
  frame.launch("reproject", kernel);
  return true;
}

PassDeclaration AttachSpecularPass::declaration() const {
  return {.name = "reproject", .stage = Stage::history, .reads = {kMeanSpecular}, .writes = {kMean}};
}

bool AttachSpecularPass::run(const FrameContext& frame) {
  if (!moves(frame)) return true;
  AttachSpecularKernel kernel;
  kernel.specular = frame.read(kMeanSpecular);
  kernel.mean = frame.write(kMean);
  kernel.width = frame.width();
  frame.launch("reproject", kernel);
  return true;
}

PassDeclaration AccumulateSpecularPass::declaration() const {
  return {.name = "accumulate",
          .stage = Stage::present,
          .reads = {kRadiance, kRadianceSpecular, kSpecularAlbedo, kSamples},
          .writes = {kMean, kMeanSpecular, kSamplesSpecular},
          .reads_if_any = {kAllocation}};
}

bool AccumulateSpecularPass::run(const FrameContext& frame) {
  AccumulateSpecularKernel kernel;
  kernel.radiance = frame.read(kRadiance);
  kernel.found = frame.read(kRadianceSpecular);
  kernel.albedo = frame.read(kSpecularAlbedo);
  kernel.allocation = frame.read(kAllocation);
  kernel.samples = frame.read(kSamples);
  kernel.specular = frame.write(kMeanSpecular);
  kernel.specular_samples = frame.write(kSamplesSpecular);
  kernel.mean = frame.write(kMean);
  kernel.width = frame.width();
  // Not to be stopped: sums change only after a complete frame.
  frame.launch("accumulate", kernel);
  return true;
}

}  // namespace relume
