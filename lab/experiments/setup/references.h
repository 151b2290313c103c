// How large images are, and the references that they are compared with.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "compare/reference.h"
#include "experiments/experiment.h"
#include "experiments/setup/scenes.h"

namespace relume {

/// 32×18 pixels in a quick run, else 192×108, `scale` times along each edge.
void set_size(const ExperimentContext& context, RenderSettings& settings, int scale = 1);

/// What set_size() sets, for ExperimentResult::setup: "192 × 108".
std::string size_text(const ExperimentContext& context);

/// A reference at the scene's camera, of `spp` samples a pixel; 0: what common_setup() says. Throws ExperimentStopped.
Reference make_reference(const ExperimentContext& context, const ExperimentScene& scene, int spp = 0);

/// What make_reference() and set_size() do, for ExperimentResult::setup.
std::vector<std::pair<std::string, std::string>> common_setup(const ExperimentContext& context);

}  // namespace relume
