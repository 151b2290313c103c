// Owner of a hash grid: memory and its size, maintenance between frames, statistics and checkpoints.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/array.h"
#include "frame/launch.h"
#include "techniques/spatial/hash_grid/maintain.h"
#include "techniques/spatial/hash_grid/settings.h"

namespace relume {

/// Statistics of the table. Counts of cells and samples are the same with any number of threads while `dropped` is 0.
struct HashGridStatistics {
  uint64_t slots = 0;
  uint64_t cells = 0;             ///< cells with samples
  float occupancy = 0;            ///< share of slots with a key
  float mean_probes = 0;          ///< mean number of slots probed for a cell
  uint64_t samples = 0;           ///< samples added in the last frame
  uint64_t evicted = 0;           ///< cells emptied for their age so far
  uint64_t discarded = 0;         ///< cells emptied so far to respect the limit of slots
  uint64_t inherited = 0;         ///< cells so far that inherited from another level
  uint64_t dropped = 0;           ///< samples dropped so far for lack of memory; results may then depend on timing
  uint64_t saturated = 0;         ///< samples clamped so far
  uint64_t nonfinite = 0;         ///< samples rejected so far
  uint64_t skipped_vertices = 0;  ///< vertices of paths without a sample so far
  uint64_t changed = 0;           ///< cells in changed regions in the last frame
  uint64_t rebuilds = 0;          ///< changes of the size and cleanings so far
  size_t memory_bytes = 0;
};

/// A cell with samples.
struct HashGridRecord {
  UVec2 key{0};  ///< fingerprint: lower and upper half
  Rgb mean{0};
  float mean_square = 0;  ///< of the luminance
  float samples = 0;      ///< number of samples
  uint32_t age = 0;       ///< frames since the last sample
};

/// Limits by the image and the machine.
struct HashGridBounds {
  uint64_t slots = 1 << 23;            ///< maximum number of slots kept from frame to frame if max-cells is 0
  uint64_t memory_slots = kMostSlots;  ///< maximum number of slots during a frame
  uint64_t samples_a_frame = 1 << 20;  ///< maximum number of additions to cells per frame
};

/// Bounds for an image whose paths have `depths` vertices with cells: four slots for each of them, within an eighth of
/// `memory_bytes`. A frame has at most about one cell per vertex, and probing is short in half-full tables. The mode
/// `undersampled_cells` determines how many coarser cells receive samples, too.
HashGridBounds bounds_for(uint64_t pixels, uint64_t depths, uint64_t memory_bytes,
                          UndersampledCells undersampled_cells = UndersampledCells::coarser);

/// Numbers of a hash grid that kernels change.
struct HashGridTally {
  HashGridCounters counters;
  HashGridCensus census;
  uint32_t overflow_count = 0;  ///< waiting samples, including those beyond the end of the list
  uint32_t longest = 0;         ///< largest displacement of a key placed between frames
};

class HashGrid {
 public:
  /// `expected_cells`: an estimate for the first size. Later sizes follow the number of cells.
  HashGrid(const HashGridSettings& settings, uint64_t expected_cells, const HashGridBounds& bounds = {},
           Memory& memory = host_memory());

  /// The same on the backend's memory, cleared in launches.
  HashGrid(Backend& backend, const HashGridSettings& settings, uint64_t expected_cells,
           const HashGridBounds& bounds = {});

  /// An empty table of the smallest size.
  explicit HashGrid(Memory& memory = host_memory()) : HashGrid(HashGridSettings{}, 0, {}, memory) {}

  /// Applies new settings. Cells whose keys they change are evicted by age. A table above its limit shrinks at the next
  /// clear() or adjust_size().
  void configure(const HashGridSettings& settings, const HashGridBounds& bounds = {});

  /// The view for the kernels of a frame. `camera` determines the level of detail.
  HashGridView view(const CameraView& camera);

  /// Call after all samples of a frame. Adds waiting samples, pools sums with histories and evicts; moments then
  /// include the frame. The table may have been rebuilt: call view() again. `watched`: the scene has changed recently,
  /// so regions are tested for changes.
  void advance(Backend& backend, bool watched = false);
  /// Call at the end of a frame, when no slot is in use. Adjusts the size. Cells beyond the limit of slots are
  /// discarded, the oldest first, and among these the ones with the fewest samples.
  void adjust_size(Backend& backend);
  /// advance(), then adjust_size().
  void end_frame(Backend& backend, bool watched = false) {
    advance(backend, watched);
    adjust_size(backend);
  }
  /// Call when a frame ends before advance(). The next adjust_size() discards its samples.
  void abandon_frame();
  /// Removes all cells in launches.
  void clear(Backend& backend);
  /// Removes all cells on the host.
  void clear();

  HashGridStatistics statistics() const;
  /// The cells as of the last advance(), sorted by key.
  std::vector<HashGridRecord> records() const;
  /// Maximum number of slots kept from frame to frame.
  uint32_t limit() const { return limit_; }

  /// The state on which later frames depend.
  std::vector<std::byte> save() const;
  /// Restores a state of save(). Returns false and changes nothing if the bytes are invalid.
  bool load(std::span<const std::byte> bytes);

 private:
  struct Unallocated {};
  HashGrid(Unallocated, const HashGridSettings& settings, uint64_t expected_cells, const HashGridBounds& bounds,
           Memory& memory);

  /// Arrays with an element per slot.
  struct Slots {
    explicit Slots(Memory& memory);
    /// Makes `count` empty slots. `reset_array(array, count, value)` sets the size and all elements of an array.
    template <typename Reset>
    void reset(uint32_t count, const Reset& reset_array);

    Array<uint64_t> fingerprints;
    Array<uint32_t> bucket_hashes;
    Array<uint32_t> parents;
    Array<CellSums> sums;
    Array<CellHistory> histories;
  };
  /// Exchanges the slots with others. Nothing is allocated, so no exception separates the arrays.
  void exchange(Slots& slots);
  /// Replaces the slots by empty ones.
  template <typename Reset>
  void allocate(uint32_t count, const Reset& reset_array);
  void allocate(uint32_t count);
  /// Resets the census and the counters of inserted keys and overflows; the slots must be empty.
  void reset_counters();
  const HashGridCounters& counters() const { return tally_.read().counters; }
  const HashGridCensus& census() const { return tally_.read().census; }
  void settle(Backend& backend);
  void rebuild(Backend& backend, uint32_t slots);
  void discard_oldest(Backend& backend, uint64_t count);
  void drop_frame(Backend& backend);
  uint32_t wanted_slots(uint64_t live) const;
  HashGridView view();
  /// The view for kernels that probe up to `probes` slots for new cells and drop samples that find none.
  HashGridView placing_view(uint32_t probes);

  HashGridSettings settings_;
  uint64_t expected_cells_;
  uint32_t limit_ = 0;         ///< maximum number of slots kept from frame to frame
  uint32_t memory_limit_ = 0;  ///< maximum number of slots during a frame
  uint32_t first_slots_ = 0;   ///< number of slots of an empty table
  bool renumbered_ = false;    ///< whether the table was rebuilt since the paths of this frame
  CellKeys keys_;              ///< keys of this frame
  Array<uint64_t> fingerprints_;
  Array<uint32_t> bucket_hashes_;
  Array<uint32_t> parents_;
  Array<CellSums> sums_;
  Array<CellHistory> histories_;
  Array<RegionChange> regions_;
  Array<WaitingSample> overflow_;  ///< uninitialised, so that unused pages take no memory
  Array<uint64_t> waiting_keys_;   ///< for distinct_keys(); empty after a frame without waiting samples
  uint64_t samples_a_frame_ = 0;   ///< wanted length of the list
  uint64_t most_waiting_ = 0;      ///< largest number of waiting samples in any frame
  KernelValue<HashGridTally> tally_;
  HashGridCounters counters_before_;  ///< counters before this frame
  bool abandoned_ = false;            ///< whether `sums_` and `parents_` are those of an abandoned frame
  bool has_abandoned_keys_ = false;   ///< whether the table has keys that an abandoned frame inserted
  uint64_t evicted_ = 0;
  uint64_t discarded_ = 0;
  uint64_t inherited_ = 0;
  uint64_t rebuilds_ = 0;
};

}  // namespace relume
