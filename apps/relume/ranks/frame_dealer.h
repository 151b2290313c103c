// Deals out the frames of a sequence to ranks.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

namespace relume::ranks {

/// Consecutive frames, by their index in the sequence.
struct Segment {
  size_t first = 0;
  size_t count = 0;
};

/// Segments become shorter towards the end. An idle rank then gets the missing frames of a segment again: the first
/// image of a frame counts.
class FrameDealer {
 public:
  /// `first`: of the frames that are not done; `longest`: frames of a segment, so that images in memory are bounded.
  FrameDealer(size_t first, size_t frames, int ranks, size_t longest);

  /// The next frames for an idle rank. std::nullopt: none for now.
  std::optional<Segment> next(int rank);
  /// Notes an image. Returns whether it is the first of its frame.
  bool received(size_t frame);
  void finished(int rank);
  bool complete() const { return missing_ == 0; }

 private:
  struct Flight {
    int rank = 0;
    Segment segment;
    bool again = false;  ///< whether two ranks have it
  };

  std::optional<Segment> rest_of(const Segment& segment) const;

  size_t next_;
  size_t ranks_;
  size_t longest_;
  std::vector<bool> received_;  ///< by frame
  size_t missing_ = 0;
  size_t before_ = 0;  ///< frames before the first one that is missing
  std::vector<Flight> flights_;
};

}  // namespace relume::ranks
