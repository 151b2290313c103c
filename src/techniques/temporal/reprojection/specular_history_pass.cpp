#include "techniques/temporal/reprojection/specular_history_pass.h"

#include "frame/primitives/fill.h"
#include "techniques/temporal/reprojection/backward_buffers.h"
#include "techniques/temporal/reprojection/motion.h"
#include "techniques/temporal/reprojection/specular_history.h"

namespace relume {

PassDeclaration SpecularHistoryPass::declaration() const {
  return {.name = "reproject",
          .stage = Stage::history,
          .owns = {{.id = kInheritedSpecularMean, .help = "specular part of inherited-mean"},
                   {.id = kInheritedSpecularSamples, .help = "number of samples in inherited-specular-mean"}},
          .reads = {kSpecularMean, kSpecularSamples, kReflection.motion, kReflection.previous, kReflection.position,
                    kReflection.normal, kReflection.depth, kReflection.surface}};
}

bool SpecularHistoryPass::run(const FrameContext& frame) {
  SpecularHistoryKernel kernel;
  kernel.before = frame.read(kSpecularMean);
  kernel.samples_before = frame.read(kSpecularSamples);
  kernel.now = frame.write(kInheritedSpecularMean);
  kernel.samples = frame.write(kInheritedSpecularSamples);
  if (!surfaces_move(frame)) {
    copy(frame.backend, "reproject", kernel.before, kernel.now);
    copy(frame.backend, "reproject", kernel.samples_before, kernel.samples);
    return true;
  }
  kernel.reflections = backward_reprojection(frame, kReflection);
  kernel.max_samples = history_limit(frame, settings_);
  frame.launch("reproject", kernel);
  return true;
}

}  // namespace relume
