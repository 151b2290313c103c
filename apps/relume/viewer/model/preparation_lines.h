// Progress of loading and compiling, as lines over the image.
#pragma once

#include <string>
#include <vector>

#include "viewer/model/state.h"

namespace relume::viewer {

/// One line each for the scene being compiled and the one being loaded, with the current step: "compiling mine ...
/// building the acceleration structure". For the displayed scene, recompiling or updating it is included once that
/// takes longer than a moment.
std::vector<std::string> preparation_lines(const State& state);

}  // namespace relume::viewer
