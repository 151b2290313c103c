// Mixtures of materials (Material::mix_first).
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "scene/scene.h"

namespace relume {

/// Parts of the mixture with that index; kNone twice if the material is none.
using MixturePartsOf = std::function<std::pair<Index, Index>(size_t material)>;

/// Throws Error if a part does not exist, or mixtures are nested in a circle or more than kMaxMixDepth deep. `place`
/// begins the message.
void check_mixtures(size_t materials, const MixturePartsOf& parts_of, const std::string& place);

}  // namespace relume
