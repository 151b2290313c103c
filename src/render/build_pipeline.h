// The explicit list of techniques: which passes a frame has for each choice in each slot.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "frame/pipeline.h"
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

/// Frames after a change whose samples leave the image again (AdaptiveSamplingSettings::pilot); 0: none do.
uint32_t pilot_samples(const RenderSettings& settings);

/// The passes that `settings` ask for, in the order of a frame: what they own, read and write. Costs no more than the
/// list: passes allocate and build nothing before their first frame. Throws Error as check_combination() does.
std::vector<PassDeclaration> plan(const RenderSettings& settings);

/// Passes that are ready to run, with copies of their settings.
struct FramePasses {
  Pipeline pipeline;
  std::vector<std::function<void(const RenderSettings&)>> followers =
      {};  ///< one hands one group of settings to a pass
};

/// The passes of plan().
FramePasses build_passes(const RenderSettings& settings);

/// Hands changed settings to the passes, which use them from the next frame on. plan() must be the same for both.
void configure(const FramePasses& passes, const RenderSettings& settings);

}  // namespace relume
