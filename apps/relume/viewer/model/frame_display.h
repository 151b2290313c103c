// Exposure and colours of the displayed frames.
#pragma once

#include <array>
#include <cstdint>

#include "viewer/model/state.h"

namespace relume::viewer {

class FrameDisplay {
 public:
  /// Adapts a side's automatic exposure to its frame, and the inspector to the buffer of a new one. Requires a frame.
  /// Returns whether the frame is new.
  bool update(State& state, int side);

  /// Colours of the side's frame. Call State::ocio.ready() first; otherwise this waits for the table.
  DisplayTransform transform(const State& state, int side) const;

 private:
  void adapt_exposure(State& state, size_t side);

  std::array<uint64_t, kSides> serials_{};
  std::array<bool, kSides> shows_buffer_{};
  std::array<const LoadedScene*, kSides> exposed_scene_{};  ///< scene that the automatic exposure belongs to
  std::array<double, kSides> exposed_s_{};
};

}  // namespace relume::viewer
