// Passes of a frame that trace its paths: the slots estimator, reuse and cache.
#pragma once

#include "render/pipeline_builder.h"
#include "techniques/spatial/octree/path_recording.h"
#include "techniques/transport/path/path_pass.h"

namespace relume {

/// Whether frames leave pixels without a sample.
bool skips_pixels(const RenderSettings& settings);

/// Whether light paths reach pixels without a camera sample.
bool needs_splat_image(const RenderSettings& settings);

/// Whether paths that fill cells choose among several lights at their primary hits, in place of a pass of reservoirs.
bool paths_resample_lights(const RenderSettings& settings);

/// Whether frames have a caustic layer: if a denoiser filters it, or for the layers beside the image.
bool has_caustic_layer(const RenderSettings& settings);

// Whether paths separate diffuse and specular light: for the denoiser, for the history, or for either.
bool denoiser_splits(const RenderSettings& settings);
bool history_splits(const RenderSettings& settings);
bool splits_light(const RenderSettings& settings);

/// Adds the estimator. `recording`: destination of path samples, or nullptr. `chains`: destinations of new states.
/// Returns the pass of path tracing without a cache, or nullptr.
PathPass* add_paths(PipelineBuilder& builder, const RenderSettings& settings, const PathSource& source,
                    const PathRecording* recording, const ChainRecordings& chains);

}  // namespace relume
