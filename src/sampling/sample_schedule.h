// Schedule of the random sequences: the sequence and the element that a frame uses.
#pragma once

#include <cstdint>

namespace relume {

/// First frame of the epoch that contains `frame`; both count from the last change. Epochs take 1, 2, 4, … frames, then
/// `longest` each, rounded down to a power of two. Each epoch therefore starts where a low-discrepancy sequence is
/// stratified from its start.
uint32_t epoch_start(uint32_t frame, uint32_t longest);

/// Frames at which sequences start over.
struct SampleSchedule {
  uint32_t longest_epoch = 0;  ///< frames; 0: no learning technique, one sequence for all frames
  uint32_t pilot = 0;          ///< frames after a change whose samples are dropped from the image; 0: none

  /// Whether the frame is the first of its epoch; always true without learning techniques.
  bool begins_epoch(uint32_t since_change) const;
  /// Index of the frame's samples within their sequence. `age`: frames since a change started the sequence.
  uint32_t sample(uint32_t age, uint32_t since_change) const;
  /// Number of the sequence that provides the frame's samples. `frames`: frames since the session began.
  uint32_t sequence(uint32_t age, uint32_t since_change, uint32_t frames) const;
};

}  // namespace relume
