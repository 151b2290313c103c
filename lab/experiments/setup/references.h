// Sets image sizes and devices, and renders references.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "compare/reference.h"
#include "experiments/experiment.h"
#include "experiments/setup/scenes.h"

namespace relume {

/// Sets the context's device, and 32×18 pixels in a quick run, else 192×108 times `scale` along each edge.
void set_size_and_device(const ExperimentContext& context, RenderSettings& settings, int scale = 1);

/// Size set by set_size_and_device(), for ExperimentResult::setup: "192 × 108".
std::string size_text(const ExperimentContext& context);

/// A view of a scene, which replaces its camera and time.
struct ReferencePose {
  std::optional<CameraPose> camera;
  float time_s = 0;
};

/// Renders references of the scene with `spp` samples per pixel; 0: the default of common_setup(). Ranks share their
/// halves. Throws ExperimentStopped.
std::vector<Reference> make_references(const ExperimentContext& context, const ExperimentScene& scene,
                                       const std::vector<ReferencePose>& poses, int spp = 0);
/// The same at the scene's camera and time.
Reference make_reference(const ExperimentContext& context, const ExperimentScene& scene, int spp = 0);

/// Conditions of make_reference() and set_size_and_device(), for ExperimentResult::setup.
std::vector<std::pair<std::string, std::string>> common_setup(const ExperimentContext& context);

}  // namespace relume
