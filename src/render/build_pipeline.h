// The explicit list of techniques: which passes a frame has for each choice in each slot.
#pragma once

#include <cstdint>
#include <string>

#include "pipeline/pipeline.h"
#include "render/render_settings.h"

namespace relume {

/// Throws Error with a sentence that says what would work if the slots do not combine.
void check_combination(const RenderSettings& settings);
/// That sentence; empty if the slots combine.
std::string refusal(const RenderSettings& settings);

/// Whether paths leave samples from which light selection or guiding learn.
bool learns(const RenderSettings& settings);

/// Changes after which every pixel starts a new sequence of samples.
Change ends_sequences(const RenderSettings& settings);

/// Frames after a change whose samples leave the picture again (AdaptiveSamplingSettings::pilot); 0: none do.
uint32_t pilot_samples(const RenderSettings& settings);

/// The passes that `settings` ask for. They keep references to `settings`, whose values they read every frame.
Pipeline build_pipeline(const RenderSettings& settings);

}  // namespace relume
