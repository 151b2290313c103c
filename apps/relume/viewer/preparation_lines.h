// What is being read or compiled, as lines over the image.
#pragma once

#include <string>
#include <vector>

#include "viewer/state.h"

namespace relume::viewer {

/// One line each for the scene that is being compiled and the one that is being read, with the step in progress:
/// "compiling mine ...  building the acceleration structure". A scene that is shown already counts once compiling it
/// again takes longer than a moment.
std::vector<std::string> preparation_lines(const State& state);

}  // namespace relume::viewer
