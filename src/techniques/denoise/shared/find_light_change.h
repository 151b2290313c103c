// Finds changes of light for the passes of denoisers. See light_change.h.
#pragma once

#include "core/array.h"
#include "frame/frame_context.h"
#include "techniques/denoise/shared/light_history.h"

namespace relume {

class LightChange {
 public:
  explicit LightChange(Memory& memory) : departures_(memory), discounts_(memory) {}

  /// LightHistory::discounts of this frame; empty if no light or object has moved. Valid until the next call.
  View<const float> discounts(const FrameContext& frame, const LightHistory& history);
  size_t memory_bytes() const { return departures_.memory_bytes() + discounts_.memory_bytes(); }

 private:
  Array<float> departures_;
  Array<float> discounts_;
};

}  // namespace relume
