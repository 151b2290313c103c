// The explicit list of techniques: the passes of a frame for each choice in each slot.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "frame/pipeline.h"
#include "render/render_settings.h"

namespace relume {

/// Throws Error with a working alternative if the slots do not combine.
void check_combination(const RenderSettings& settings);
/// Message of that error; empty if the slots combine.
std::string refusal(const RenderSettings& settings);

/// Whether light selection or guiding learn from path samples.
bool learns(const RenderSettings& settings);
/// Whether they learn in the regions of the octree, or by Markov chains in cells.
bool learns_regions(const RenderSettings& settings);
bool learns_in_chains(const RenderSettings& settings);
/// Whether guiding learns importance for light subpaths.
bool learns_importance(const RenderSettings& settings);

/// Whether the history needs the first vertices of paths.
bool needs_first_vertices(const RenderSettings& settings);

/// Whether the frame has the passes of temporal upscaling.
bool upscales(const RenderSettings& settings);

/// Whether the denoiser's own history fills pixels without samples.
bool denoiser_fills(const RenderSettings& settings);

/// Changes after which every pixel starts a new sample sequence.
Change ends_sequences(const RenderSettings& settings);

/// Frames after a change whose samples are later dropped from the image (AdaptiveSamplingSettings::pilot); 0: none.
uint32_t pilot_samples(const RenderSettings& settings);

/// Declarations of the passes for `settings`, in the order of a frame. Cheap: passes allocate and build nothing before
/// their first frame. Throws Error as check_combination() does.
std::vector<PassDeclaration> plan(const RenderSettings& settings);

/// Runnable passes with copies of their settings.
struct FramePasses {
  Pipeline pipeline;
  std::vector<std::function<void(const RenderSettings&)>> followers =
      {};  ///< each passes one group of settings to a pass
};

/// The passes of plan(). `memory`: for the data that their kernels access; it must outlive them.
FramePasses build_passes(const RenderSettings& settings, Memory& memory);

/// Passes changed settings to the passes, which use them from the next frame on. plan() must be equal for both
/// settings.
void configure(const FramePasses& passes, const RenderSettings& settings);

}  // namespace relume
