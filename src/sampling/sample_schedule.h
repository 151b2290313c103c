// Which element of which sequence of random numbers a frame takes.
#pragma once

#include <cstdint>

namespace relume {

/// First frame of the epoch to which `frame` belongs; both count from the last change. Epochs take 1, 2, 4, … frames
/// and then `longest` each, rounded down to a power of two, so that each begins where a low-discrepancy sequence is
/// stratified from its start.
uint32_t epoch_start(uint32_t frame, uint32_t longest);

/// When sequences start again.
struct SampleSchedule {
  uint32_t longest_epoch = 0;  ///< frames; 0: nothing learns, and one sequence serves all frames
  uint32_t pilot = 0;          ///< frames after a change whose samples leave the image; 0: none do

  /// Whether the frame is the first of its epoch; always true where nothing learns.
  bool begins_epoch(uint32_t since_change) const;
  /// Index of the frame's samples. `age`: frames since a change started the sequence.
  uint32_t sample(uint32_t age, uint32_t since_change) const;
  /// Number of the sequence that the frame's samples come from. `frames`: frames since the session began.
  uint32_t sequence(uint32_t age, uint32_t since_change, uint32_t frames) const;
};

}  // namespace relume
