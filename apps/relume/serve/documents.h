// JSON texts that describe the state to viewers.
#pragma once

#include <string>

#include "viewer/model/state.h"

namespace relume::serve {

/// Scene, presets, and all settings with names, help, types, ranges, choices and defaults. Does not change.
std::string declarations_text(const viewer::State& state);

/// Settings of both sides, choices that do not combine with the others, settings without effect, and buffers.
std::string values_text(const viewer::State& state);
/// Changes with values_text(), and is faster to make.
std::string values_key(const viewer::State& state);

/// Rates, times by pass, messages, camera, and the state of buttons.
std::string status_text(const viewer::State& state);

}  // namespace relume::serve
