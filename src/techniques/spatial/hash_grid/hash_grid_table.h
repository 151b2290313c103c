// Owner of a hash grid's memory: sizes, upkeep between frames, statistics, and a form that goes into checkpoints.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "frame/launch.h"
#include "techniques/spatial/hash_grid/maintain.h"
#include "techniques/spatial/hash_grid/settings.h"

namespace relume {

/// State of the table, for statistics. Counts of cells and samples are the same with any number of threads while
/// `dropped` is 0.
struct HashGridStatistics {
  uint64_t slots = 0;
  uint64_t cells = 0;             ///< with samples
  float occupancy = 0;            ///< share of slots that have a key
  float mean_probes = 0;          ///< slots looked at to find a cell
  uint64_t samples = 0;           ///< added in the last frame
  uint64_t evicted = 0;           ///< cells emptied for their age so far
  uint64_t discarded = 0;         ///< cells emptied so far because a smaller table had to do
  uint64_t inherited = 0;         ///< cells so far that began with what another level knew
  uint64_t dropped = 0;           ///< samples without memory so far; results may then depend on timing
  uint64_t saturated = 0;         ///< samples clamped so far
  uint64_t nonfinite = 0;         ///< samples left out so far
  uint64_t skipped_vertices = 0;  ///< vertices of paths without room for a sample so far
  uint64_t changed = 0;           ///< cells in the last frame whose region was seen to change
  uint64_t rebuilds = 0;          ///< times that the table changed its size or was cleaned
  size_t memory_bytes = 0;
};

/// What the image and the machine allow.
struct HashGridBounds {
  uint64_t slots = 1 << 23;            ///< between frames, where the setting max-cells leaves it open
  uint64_t memory_slots = kMostSlots;  ///< while a frame has more cells than that
  uint64_t samples_a_frame = 1 << 20;  ///< additions to cells, at most
};

/// Bounds for an image whose paths have `depths` vertices with cells: four slots for each of them, within an eighth of
/// `memory_bytes`. A frame makes about one cell a vertex at most, and half-full tables are quick.
HashGridBounds bounds_for(uint64_t pixels, uint64_t depths, uint64_t memory_bytes);

class HashGrid {
 public:
  /// `expected_cells`: a guess at how many there will be; the size follows the number found.
  HashGrid(const HashGridSettings& settings, uint64_t expected_cells, const HashGridBounds& bounds = {});

  /// An empty table of the smallest size.
  HashGrid() : HashGrid(HashGridSettings{}, 0) {}

  /// Takes new settings on. Cells whose keys they change are evicted in time; a table above its limit shrinks when
  /// clear() or adjust_size() is called next.
  void configure(const HashGridSettings& settings, const HashGridBounds& bounds = {});

  /// For the kernels of a frame. `camera` sets the level of detail.
  HashGridView view(const CameraView& camera);

  /// Call when the samples of a frame are in. Gives waiting samples their cells, averages and evicts; moments include
  /// the frame from then on. The table may have been rebuilt: take a new view(). `watched`: the scene has changed of
  /// late, so histories are compared with the frame, region by region.
  void advance(Backend& backend, bool watched = false);
  /// Call at the end of a frame, when no slot is in use. Adjusts the size. Where max-cells or memory allow
  /// fewer cells than there are, the oldest go, and of these the ones with the fewest samples.
  void adjust_size(Backend& backend);
  /// Both.
  void end_frame(Backend& backend, bool watched = false) {
    advance(backend, watched);
    adjust_size(backend);
  }
  /// Call when a frame ends before advance(): the next adjust_size() forgets its samples.
  void abandon_frame();
  /// Forgets everything.
  void clear();

  HashGridStatistics statistics() const;
  /// Slots between frames, at most.
  uint32_t limit() const { return limit_; }

  /// Everything that later frames depend on.
  std::vector<std::byte> save() const;
  /// The state that save() gave. False, and nothing changes, if the bytes are no such state.
  bool load(std::span<const std::byte> bytes);

 private:
  void allocate(uint32_t slots);
  void settle(Backend& backend);
  void rebuild(Backend& backend, uint32_t slots);
  void discard_oldest(uint64_t count);
  void drop_frame(Backend& backend);
  uint32_t wanted_slots(uint64_t live) const;
  HashGridView view();
  /// For kernels that place cells up to `probes` slots from where probing begins, and drop samples without a place.
  HashGridView placing_view(uint32_t probes);

  HashGridSettings settings_;
  uint64_t expected_cells_;
  uint32_t limit_ = 0;         ///< slots between frames, at most
  uint32_t memory_limit_ = 0;  ///< slots at most, ever
  uint32_t first_slots_ = 0;   ///< of an empty table
  uint32_t longest_ = 0;       ///< slots between a key and its first slot, at most, in the table as it was built
  bool renumbered_ = false;    ///< since the paths of this frame
  CellKeys keys_;              ///< of this frame
  std::vector<uint64_t> fingerprints_;
  std::vector<uint32_t> bucket_hashes_;
  std::vector<uint32_t> parents_;
  std::vector<CellSums> sums_;
  std::vector<CellHistory> histories_;
  std::vector<RegionChange> regions_;
  std::unique_ptr<std::byte[]> overflow_;  ///< uninitialised, so that only what is used takes memory
  uint64_t overflow_capacity_ = 0;         ///< samples
  uint64_t samples_a_frame_ = 0;           ///< for which the list is to have room
  uint32_t overflow_count_ = 0;
  uint64_t most_waiting_ = 0;  ///< samples, of all frames
  HashGridCounters counters_;
  HashGridCounters counters_before_;  ///< this frame
  bool abandoned_ = false;            ///< `sums_` and `parents_` hold samples of a frame that was abandoned
  bool has_abandoned_keys_ = false;   ///< the table has keys that such a frame made
  HashGridCensus census_;
  uint64_t evicted_ = 0;
  uint64_t discarded_ = 0;
  uint64_t inherited_ = 0;
  uint64_t rebuilds_ = 0;
};

}  // namespace relume
