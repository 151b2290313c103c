// Launch of the kernel that traces one path per pixel.
#pragma once

#include "techniques/transport/path/path_kernel.h"
#include "techniques/transport/path/path_pass.h"

namespace relume {

/// Traces a path for each pixel that receives a sample, for a pass that owns estimator_buffers(). `outputs`:
/// those of PathOutputs. `first_surfaces`: receives the surfaces at primary hits if it expects them in this frame; may
/// be nullptr. Returns false if a stop was requested first.
template <typename... Outputs>
bool trace_paths(const PathSource& source, const FrameContext& frame, const FirstSurfaces* first_surfaces,
                 const Outputs&... outputs) {
  const PathKernel<Outputs...> kernel{.context = make_path_context(source, frame),
                                      .index = frame.index,
                                      .hits = frame.read(kPrimaryHits),
                                      .allocation = frame.read(kAllocation),
                                      .rays = frame.write(kRays),
                                      .width = frame.width(),
                                      .outputs = path_outputs(outputs...)};
  if (!first_surfaces || !first_surfaces->expected()) return frame.launch_or_stop("trace", kernel);
  return frame.launch_tiles_or_stop("trace",
                                    [&](const Tile& tile) { path_batch::trace_tile(kernel, tile, first_surfaces); });
}

}  // namespace relume
