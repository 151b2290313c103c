#include "techniques/reprojection/specular_history_pass.h"

#include "techniques/reprojection/backward_buffers.h"
#include "techniques/reprojection/specular_history.h"

namespace relume {
namespace {

constexpr Change kEnds = Change::materials | Change::settings;
constexpr Change kMovesScene = Change::geometry | Change::lights;

bool moves(const FrameContext& frame) {
  return frame.number > 0 && !includes(frame.changes, kEnds) && includes(frame.changes, Change::camera | kMovesScene);
}

}  // namespace

PassDeclaration DetachSpecularPass::declaration() const {
  const auto kept = [](const char* name, BufferType type, const char* help) {
    return BufferDescription{
        .name = name, .type = type, .help = help, .persistent = true, .reset = kEnds, .display = BufferDisplay::value};
  };
  return {.name = "reproject",
          .stage = Stage::history,
          .owns = {kept("mean-specular", BufferType::rgb32f, "specular part of mean"),
                   kept("samples-specular", BufferType::u32, "samples in mean-specular")},
          .reads = {"specular-motion", "specular-previous", "specular-position", "specular-normal", "specular-depth",
                    "feature-surface"},
          .writes = {"mean"}};
}

bool DetachSpecularPass::run(const FrameContext& frame) {
  if (!moves(frame)) return true;
  DetachSpecularKernel kernel;
  kernel.reflections = backward_reprojection(frame, {.motion = "specular-motion",
                                                     .previous = "specular-previous",
                                                     .position = "specular-position",
                                                     .normal = "specular-normal",
                                                     .depth = "specular-depth",
                                                     .surface = "feature-surface"});
  kernel.specular = frame.view<Rgb>("mean-specular");
  kernel.samples = frame.view<uint32_t>("samples-specular");
  specular_before_.assign(kernel.specular.begin(), kernel.specular.end());
  samples_before_.assign(kernel.samples.begin(), kernel.samples.end());
  kernel.specular_before = view_of(specular_before_);
  kernel.samples_before = view_of(samples_before_);
  kernel.mean = frame.view<Rgb>("mean");
  kernel.max_samples = static_cast<uint32_t>(includes(frame.changes, kMovesScene) ? settings_.max_samples_changed
                                                                                  : settings_.max_samples);
  launch(frame.backend, "reproject", kernel, frame.width(), frame.height());
  return true;
}

PassDeclaration AttachSpecularPass::declaration() const {
  return {.name = "reproject", .stage = Stage::history, .reads = {"mean-specular"}, .writes = {"mean"}};
}

bool AttachSpecularPass::run(const FrameContext& frame) {
  if (!moves(frame)) return true;
  AttachSpecularKernel kernel;
  kernel.specular = frame.view<const Rgb>("mean-specular");
  kernel.mean = frame.view<Rgb>("mean");
  kernel.width = frame.width();
  launch(frame.backend, "reproject", kernel, frame.width(), frame.height());
  return true;
}

PassDeclaration AccumulateSpecularPass::declaration() const {
  return {.name = "accumulate",
          .stage = Stage::present,
          .reads = {"radiance", "radiance-specular", "specular-albedo", "samples"},
          .writes = {"mean", "mean-specular", "samples-specular"},
          .reads_if_any = {"allocation"}};
}

bool AccumulateSpecularPass::run(const FrameContext& frame) {
  AccumulateSpecularKernel kernel;
  kernel.radiance = frame.view<const Rgb>("radiance");
  kernel.found = frame.view<const Rgb>("radiance-specular");
  kernel.albedo = frame.view<const Rgb>("specular-albedo");
  kernel.allocation = frame.view<const uint32_t>("allocation");
  kernel.samples = frame.view<const uint32_t>("samples");
  kernel.specular = frame.view<Rgb>("mean-specular");
  kernel.specular_samples = frame.view<uint32_t>("samples-specular");
  kernel.mean = frame.view<Rgb>("mean");
  kernel.width = frame.width();
  // Not to be stopped: sums change only after a complete frame.
  return launch(frame.backend, "accumulate", kernel, frame.width(), frame.height());
}

}  // namespace relume
