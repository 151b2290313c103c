// Owner of a hash grid's memory: sizes, upkeep between frames, statistics, and a form that goes into checkpoints.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "backend/launch.h"
#include "techniques/hash_grid/maintain.h"
#include "techniques/hash_grid/settings.h"

namespace relume {

/// State of the table, for statistics. All but `mean_probes` are the same with any number of threads, and `dropped`
/// too while it is 0.
struct HashGridStatistics {
  uint64_t slots = 0;
  uint64_t cells = 0;      ///< with samples
  float occupancy = 0;     ///< share of slots that have a key
  float mean_probes = 0;   ///< slots looked at to find a cell
  uint64_t samples = 0;    ///< added in the last frame
  uint64_t evicted = 0;    ///< cells emptied so far
  uint64_t inherited = 0;  ///< cells so far that began with what another level knew
  uint64_t dropped = 0;    ///< samples and cells without a place so far; results may then depend on timing
  uint64_t saturated = 0;  ///< samples clamped so far
  uint64_t nonfinite = 0;  ///< samples left out so far
  uint64_t unfed = 0;      ///< vertices of paths without room for a sample so far
  uint64_t changed = 0;    ///< cells in the last frame whose region was seen to change
  uint64_t rebuilds = 0;   ///< times that the table changed its size or was cleaned
  size_t memory_bytes = 0;
};

/// Most slots of a table whose settings leave that open, for a picture whose paths have `depths` vertices with cells:
/// four for each of them, within an eighth of `memory_bytes`. A frame makes about one cell a vertex at most, and
/// half-full tables are quick.
uint64_t open_slot_limit(uint64_t pixels, uint64_t depths, uint64_t memory_bytes);

class HashGrid {
 public:
  /// `expected_cells`: a guess at how many there will be; the size follows what is found. `open_limit`: slots at most
  /// if the settings leave that open.
  HashGrid(const HashGridSettings& settings, uint64_t expected_cells, uint64_t open_limit = kDefaultLimit);

  /// An empty table of the smallest size.
  HashGrid() : HashGrid(HashGridSettings{}, 0) {}

  /// Takes new settings on. Cells whose keys they change are evicted in time; a table above its limit shrinks when
  /// clear() or adjust_size() is called next.
  void configure(const HashGridSettings& settings, uint64_t open_limit = kDefaultLimit);

  /// For the kernels of a frame. `camera` sets the level of detail.
  HashGridView view(const CameraView& camera);

  /// When the samples of a frame are in: averages and evicts. What is read from then on includes them. `watched`: the
  /// scene has changed of late, so cells are compared with what they remember, region by region.
  void advance(Backend& backend, bool watched = false);
  /// When a frame is over and nobody knows slots any more: adjusts the size.
  void adjust_size(Backend& backend);
  /// Both.
  void end_frame(Backend& backend, bool watched = false) {
    advance(backend, watched);
    adjust_size(backend);
  }
  /// Forgets everything.
  void clear();

  HashGridStatistics statistics() const;
  /// Slots at most.
  uint32_t limit() const { return limit_; }

  /// Everything that later frames depend on.
  std::vector<std::byte> save() const;
  /// The state that save() gave. False, and nothing changes, if the bytes are no such state. Cells that have no room
  /// within the limit are dropped and counted.
  bool load(std::span<const std::byte> bytes);

 private:
  static constexpr uint64_t kDefaultLimit = 1 << 23;

  void allocate(uint32_t slots);
  void rebuild(Backend& backend, uint32_t slots);
  uint32_t wanted_slots(uint64_t live) const;

  HashGridSettings settings_;
  uint64_t expected_cells_;
  uint32_t limit_ = 0;        ///< slots at most
  uint32_t first_slots_ = 0;  ///< of an empty table
  std::vector<uint64_t> fingerprints_;
  std::vector<uint32_t> homes_;
  std::vector<uint32_t> parents_;
  std::vector<CellSums> sums_;
  std::vector<CellHistory> histories_;
  std::vector<RegionChange> regions_;
  HashGridCounters counters_;
  HashGridCensus census_;
  uint64_t evicted_ = 0;
  uint64_t inherited_ = 0;
  uint64_t rebuilds_ = 0;
  uint64_t dropped_before_ = 0;  ///< when the size was adjusted last
};

}  // namespace relume
