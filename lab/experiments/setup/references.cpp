#include "experiments/setup/references.h"

#include <optional>
#include <utility>

#include <fmt/format.h>

namespace relume {
namespace {

/// Samples per pixel for a paper's scenes; variations use half as many.
int reference_spp(const ExperimentContext& context) { return context.choose(1024, 16); }

}  // namespace

void set_size_and_device(const ExperimentContext& context, RenderSettings& settings, int scale) {
  settings.width = context.choose(192 * scale, 32);
  settings.height = context.choose(108 * scale, 18);
  settings.device = context.device;
}

std::string size_text(const ExperimentContext& context) {
  RenderSettings settings;
  set_size_and_device(context, settings);
  return fmt::format("{} × {}", settings.width, settings.height);
}

Reference make_reference(const ExperimentContext& context, const ExperimentScene& scene, int spp) {
  RenderSettings settings = scene.settings;
  set_size_and_device(context, settings, scene.scale);
  if (spp == 0) spp = scene.property.empty() ? reference_spp(context) : reference_spp(context) / 2;
  ReferenceRenderer renderer(scene.scene, settings, spp, context.cache_folder, context.program);
  const float time_s = settings.time_s;
  std::optional<Reference> reference =
      renderer.render(time_s, time_s, scene.camera, context.stop,
                      [&](double fraction) { context.report("reference of " + scene.name, fraction); });
  if (!reference) throw ExperimentStopped();
  return std::move(*reference);
}

std::vector<std::pair<std::string, std::string>> common_setup(const ExperimentContext& context) {
  return {{"Size", size_text(context) + " (the paper: 1280 × 720)"},
          {"Reference", fmt::format("{} samples per pixel, half as many for variations (the paper: 4096); its own "
                                    "noise is known and subtracted from every MSE",
                                    reference_spp(context))}};
}

}  // namespace relume
