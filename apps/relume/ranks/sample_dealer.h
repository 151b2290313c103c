// Deals out the samples of an image to ranks.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "parts/sample_ranges.h"

namespace relume::ranks {

/// Sample indices of one replica, from a multiple on. They only have to differ from those of others.
inline constexpr uint32_t kLaneSamples = 1u << 14;

/// Samples for one rank, from a multiple of kBlockSamples on.
struct Deal {
  uint32_t id = 0;
  uint32_t first = 0;
  uint32_t count = 0;
};

struct DealerSettings {
  uint32_t samples = 0;  ///< of the whole image; 0: no limit
  int ranks = 1;
  bool adapt = false;      ///< whether samples adapt: each rank then continues a replica of its own
  double target_s = 5;     ///< duration of a deal, unless the minimum number of blocks takes longer
  SampleRanges done = {};  ///< of a checkpoint
};

/// Ranks ask for samples when they have none. Deals take about DealerSettings::target_s at the measured speed of their
/// rank, and become smaller towards the end. Once none are left, an idle rank gets those of a slow rank again, if it
/// will be faster: the first result counts.
class SampleDealer {
 public:
  explicit SampleDealer(const DealerSettings& settings);

  /// The next samples for a rank; std::nullopt: none for now. `now_s`: a monotonic clock.
  std::optional<Deal> next(int rank, double now_s);
  /// Notes that a rank has rendered a deal whose result has not arrived: no other rank needs to render it again.
  void rendered(uint32_t id);
  /// Notes the result of a rank that has rendered the first `count` samples of a deal in `seconds`. Returns whether
  /// they count: not if another rank was first. Samples of the deal that are missing are dealt again.
  bool finished(int rank, uint32_t id, uint32_t count, double seconds);
  /// Notes how long rank 0 took to add a result. Last deals take at least that long for each rank, so that results do
  /// not wait for each other.
  void added(double seconds) { add_s_ = add_s_ > 0 ? 0.5 * (add_s_ + seconds) : seconds; }
  /// The ranks that still work on a deal that has a result. They are free after the call.
  std::vector<int> take_late(uint32_t id);

  /// The samples that have counted.
  const SampleRanges& done() const { return done_; }
  bool complete() const { return settings_.samples > 0 && done_.count() >= settings_.samples; }
  /// Whether no rank works.
  bool idle() const { return flights_.empty(); }

 private:
  struct Worker {
    int rank = 0;
    double start_s = 0;
  };
  struct Flight {
    Deal deal;
    std::vector<Worker> workers;
    bool rendered = false;
    bool done = false;
  };

  uint32_t blocks_for(int rank) const;
  std::optional<Deal> take_new(int rank);
  std::optional<Deal> take_late_deal(int rank, double now_s);
  uint32_t unclaimed() const;

  DealerSettings settings_;
  std::deque<SampleRange> todo_;  ///< ranges that are not dealt, in order
  std::vector<Flight> flights_;
  SampleRanges done_;
  std::vector<double> sample_s_;    ///< seconds per sample by rank; 0: unknown
  double add_s_ = 0;                ///< seconds for which rank 0 adds a result; 0: unknown
  std::vector<SampleRange> lanes_;  ///< by rank, the indices that are left to its replica; empty: first > last
  uint32_t next_lane_ = 0;          ///< first index of the next replica
  uint32_t dealt_ = 0;              ///< samples that are done or dealt, if samples adapt
  uint32_t next_id_ = 1;
};

}  // namespace relume::ranks
