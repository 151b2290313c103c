// Random combinations of three or more choices of slots.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "combinations/cells.h"
#include "render/render_settings.h"

namespace relume::support {

/// Three or more choices of different slots in the settings' order, none of which is the default.
using Triple = std::vector<Choice>;

/// The first `count` distinct triples that the rules of combination permit, of a random sequence that only depends on
/// the slots. If a rule is removed, triples that it refused take their places in the list. Open Image Denoise is left
/// out, since its bits may depend on threads.
std::vector<Triple> draw_triples(size_t count);

/// Up to `count` of the triples. Each has the most choices that those before it lack.
std::vector<Triple> covering(std::vector<Triple> triples, size_t count);

RenderSettings combine(RenderSettings settings, const Triple& triple);

/// "estimator_vcm_lights_vlc_denoise_svgf"
std::string triple_name(const Triple& triple);

/// "relume render cornell --estimator vcm --lights vlc --denoise svgf"
std::string command_of(const Triple& triple);

}  // namespace relume::support
