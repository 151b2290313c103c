// The passes of the à-trous filter over an image, each twice as wide as the one before, and the images that they need.
#pragma once

#include "core/array.h"
#include "frame/frame_context.h"
#include "frame/primitives/fill.h"
#include "techniques/denoise/svgf/atrous.h"

namespace relume {

struct AtrousLevels {
  uint32_t width = 0;  ///< of all images, pixels
  uint32_t height = 0;
  int count = 0;
  float plane_tolerance = 0;  ///< as in AtrousKernel
  float light_tolerance = 0;

  AtrousImage image(Array<float>& values) const { return {values.mutable_view(), width, height}; }

  /// Sets the size of an image, in a launch with this name.
  void resize(Backend& backend, std::string_view name, Array<float>& values, uint32_t planes) const {
    const size_t size = AtrousImage::size(planes, width, height);
    if (values.size() != size) relume::resize(backend, name, values, size);
  }

  /// Replaces `light` by the result. Returns false if a stop was requested first.
  [[nodiscard]] bool filter(const FrameContext& frame, std::string_view name, Array<float>& features,
                            Array<float>& light, Array<float>& scratch) const {
    for (int level = 0; level < count; ++level) {
      AtrousKernel kernel;
      kernel.features = image(features);
      kernel.light = image(light);
      kernel.filtered = image(scratch);
      kernel.step = 1u << level;
      kernel.plane_tolerance = plane_tolerance;
      kernel.light_tolerance = light_tolerance;
      if (!frame.launch_or_stop(name, kernel, {width, height})) return false;
      light.swap(scratch);
    }
    return true;
  }
};

}  // namespace relume
