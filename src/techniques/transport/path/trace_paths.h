// How passes launch the kernel that traces one path a pixel.
#pragma once

#include "techniques/transport/path/path_kernel.h"
#include "techniques/transport/path/path_pass.h"

namespace relume {

/// Traces a path for each pixel that the allocation gives one; `observation` as for ObservedPathKernel. Of a pass that
/// owns estimator_buffers(). False if a stop was requested first.
template <typename Observation>
bool trace_paths(const PathSource& source, const FrameContext& frame, const Observation& observation) {
  const ObservedPathKernel<Observation> kernel{.context = make_path_context(source, frame),
                                               .index = frame.index,
                                               .hits = frame.read(kPrimaryHits),
                                               .allocation = frame.read(kAllocation),
                                               .rays = frame.write(kRays),
                                               .width = frame.width(),
                                               .observation = observation};
  return frame.launch_or_stop("trace", kernel);
}

}  // namespace relume
