// Finds changes of light for the passes of denoisers. See light_change.h.
#pragma once

#include <vector>

#include "frame/frame_context.h"
#include "techniques/denoise/shared/light_history.h"

namespace relume {

class LightChange {
 public:
  /// LightHistory::discounts of this frame; empty if no light or object has moved. Valid until the next call.
  View<const float> discounts(const FrameContext& frame, const LightHistory& history);
  size_t memory_bytes() const { return (departures_.size() + discounts_.size()) * sizeof(float); }

 private:
  std::vector<float> departures_;
  std::vector<float> discounts_;
};

}  // namespace relume
