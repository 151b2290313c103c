#include "experiments/setup/references.h"

#include <optional>
#include <utility>

#include <fmt/format.h>

#include "compare/shared_references.h"
#include "experiments/shared_parts.h"

namespace relume {
namespace {

/// Samples per pixel for a paper's scenes; variations use half as many.
int reference_spp(const ExperimentContext& context) { return context.choose(1024, 16); }

/// `scene` must outlive the renderer.
ReferenceRenderer renderer_of(const ExperimentContext& context, const ExperimentScene& scene, const ReferencePose& pose,
                              int spp) {
  RenderSettings settings = scene.settings;
  set_size_and_device(context, settings, scene.scale);
  settings.time_s = pose.time_s;
  return {scene.scene, settings, spp, context.cache_folder, context.program};
}

std::vector<Reference> references_of_ranks(const ExperimentContext& context, const ExperimentScene& scene,
                                           const std::vector<ReferencePose>& poses, int spp, const std::string& stage) {
  std::vector<ReferenceRenderer> renderers;
  renderers.reserve(poses.size());
  std::vector<ReferenceView> views;
  std::string step = stage;
  for (const ReferencePose& pose : poses) {
    renderers.push_back(renderer_of(context, scene, pose, spp));
    views.push_back({&renderers.back(), pose.time_s, pose.time_s, pose.camera});
    // The name hashes all conditions.
    step += " " + renderers.back().file(pose.time_s, pose.time_s, pose.camera).filename().string();
  }
  check_step(context, step);
  std::optional<std::vector<Reference>> references =
      share_references(*context.ranks, views, context.stop, [&](double fraction) { context.report(stage, fraction); });
  if (!references) throw ExperimentStopped();
  return std::move(*references);
}

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

std::vector<Reference> make_references(const ExperimentContext& context, const ExperimentScene& scene,
                                       const std::vector<ReferencePose>& poses, int spp) {
  if (spp == 0) spp = scene.property.empty() ? reference_spp(context) : reference_spp(context) / 2;
  const std::string stage = "reference of " + scene.name;
  if (context.ranks) return references_of_ranks(context, scene, poses, spp, stage);
  std::vector<Reference> references;
  for (const ReferencePose& pose : poses) {
    ReferenceRenderer renderer = renderer_of(context, scene, pose, spp);
    std::optional<Reference> reference = renderer.render(pose.time_s, pose.time_s, pose.camera, context.stop,
                                                         [&](double fraction) { context.report(stage, fraction); });
    if (!reference) throw ExperimentStopped();
    references.push_back(std::move(*reference));
  }
  return references;
}

Reference make_reference(const ExperimentContext& context, const ExperimentScene& scene, int spp) {
  return std::move(make_references(context, scene, {{scene.camera, scene.settings.time_s}}, spp).front());
}

std::vector<std::pair<std::string, std::string>> common_setup(const ExperimentContext& context) {
  return {{"Size", size_text(context) + " (the paper: 1280 × 720)"},
          {"Reference", fmt::format("{} samples per pixel, half as many for variations (the paper: 4096); its own "
                                    "noise is known and subtracted from every MSE",
                                    reference_spp(context))}};
}

}  // namespace relume
