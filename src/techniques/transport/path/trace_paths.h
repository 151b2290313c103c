// Launch of the kernel that traces one path per pixel.
#pragma once

#include "techniques/transport/path/path_kernel.h"
#include "techniques/transport/path/path_pass.h"

namespace relume {

/// Traces a path for each pixel that receives a sample, for a pass that owns estimator_buffers(). `outputs`:
/// those of PathOutputs. Returns false if a stop was requested first.
template <typename... Outputs>
bool trace_paths(const PathSource& source, const FrameContext& frame, const Outputs&... outputs) {
  const PathKernel<Outputs...> kernel{.context = make_path_context(source, frame),
                                      .index = frame.index,
                                      .hits = frame.read(kPrimaryHits),
                                      .allocation = frame.read(kAllocation),
                                      .rays = frame.write(kRays),
                                      .width = frame.width(),
                                      .outputs = path_outputs(outputs...)};
  return frame.launch_or_stop("trace", kernel);
}

}  // namespace relume
