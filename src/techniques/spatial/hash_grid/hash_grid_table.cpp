#include "techniques/spatial/hash_grid/hash_grid_table.h"

#include <algorithm>
#include <utility>

#include "frame/primitives/fill.h"
#include "techniques/spatial/hash_grid/discard.h"

namespace relume {
namespace {

/// Slots per expected cell. adjust_size() keeps the table at most half full, so that probing stays short.
constexpr uint64_t kSlotsPerCell = 4;
constexpr uint32_t kMinSlots = 1024;

constexpr uint64_t kSlotBytes = sizeof(uint64_t) + 2 * sizeof(uint32_t) + sizeof(CellSums) + sizeof(CellHistory);

/// Probes all slots.
constexpr uint32_t kAnywhere = kNoCell;

uint32_t rows_of(size_t slots) { return static_cast<uint32_t>((slots + kMaintenanceRow - 1) / kMaintenanceRow); }

/// Maximum number of cells between frames: seven eighths of the slots, so that probing ends.
uint64_t capacity_of(uint32_t slots) { return std::max<uint64_t>(1, uint64_t{slots} * 7 / 8); }

/// For Slots::reset(): resets arrays in launches.
auto in_launches(Backend& backend) {
  return [&backend](auto& array, uint32_t count, const auto& value) { reset(backend, "cells", array, count, value); };
}

}  // namespace

HashGridBounds bounds_for(uint64_t pixels, uint64_t depths, uint64_t memory_bytes,
                          UndersampledCells undersampled_cells) {
  const uint64_t in_memory = std::clamp(memory_bytes / 8 / kSlotBytes, uint64_t{kMinSlots}, uint64_t{kMostSlots});
  const uint64_t wanted = std::max(pixels * depths * kSlotsPerCell, uint64_t{1} << 20);
  // One sample in eight is added to a coarser cell, too; with neighbours, one in two.
  const uint64_t quarters = undersampled_cells == UndersampledCells::neighbours_coarser ? 8 : 5;
  return {std::min(wanted, in_memory), in_memory, pixels * depths * quarters / 4 + kMinSlots};
}

HashGrid::HashGrid(const HashGridSettings& settings, uint64_t expected_cells, const HashGridBounds& bounds,
                   Memory& memory)
    : HashGrid(Unallocated(), settings, expected_cells, bounds, memory) {
  allocate(first_slots_);
}

HashGrid::HashGrid(Backend& backend, const HashGridSettings& settings, uint64_t expected_cells,
                   const HashGridBounds& bounds)
    : HashGrid(Unallocated(), settings, expected_cells, bounds, backend.memory()) {
  allocate(first_slots_, in_launches(backend));
}

HashGrid::HashGrid(Unallocated, const HashGridSettings& settings, uint64_t expected_cells, const HashGridBounds& bounds,
                   Memory& memory)
    : expected_cells_(std::min(expected_cells, uint64_t{kMostSlots})),
      fingerprints_(memory),
      bucket_hashes_(memory),
      parents_(memory),
      sums_(memory),
      histories_(memory),
      regions_(memory),
      overflow_(memory),
      waiting_keys_(memory),
      tally_(memory) {
  configure(settings, bounds);
}

void HashGrid::configure(const HashGridSettings& settings, const HashGridBounds& bounds) {
  settings_ = settings;
  const uint64_t limit = settings.max_cells > 0 ? static_cast<uint64_t>(settings.max_cells) : bounds.slots;
  limit_ = static_cast<uint32_t>(std::clamp(limit, uint64_t{1}, uint64_t{kMostSlots}));
  memory_limit_ = std::max(limit_, static_cast<uint32_t>(std::min(bounds.memory_slots, uint64_t{kMostSlots})));
  first_slots_ = wanted_slots(expected_cells_);
  samples_a_frame_ = std::min(bounds.samples_a_frame, uint64_t{kNoCell});
}

uint32_t HashGrid::wanted_slots(uint64_t live) const {
  return static_cast<uint32_t>(std::min(std::max(live * kSlotsPerCell, uint64_t{kMinSlots}), uint64_t{limit_}));
}

HashGrid::Slots::Slots(Memory& memory)
    : fingerprints(memory), bucket_hashes(memory), parents(memory), sums(memory), histories(memory) {}

template <typename Reset>
void HashGrid::Slots::reset(uint32_t count, const Reset& reset_array) {
  reset_array(fingerprints, count, uint64_t{0});
  reset_array(bucket_hashes, count, 0u);
  reset_array(parents, count, kNoCell);
  reset_array(sums, count, CellSums{});
  reset_array(histories, count, CellHistory{});
}

void HashGrid::exchange(Slots& slots) {
  fingerprints_.swap(slots.fingerprints);
  bucket_hashes_.swap(slots.bucket_hashes);
  parents_.swap(slots.parents);
  sums_.swap(slots.sums);
  histories_.swap(slots.histories);
  tally_.write().longest = 0;
}

template <typename Reset>
void HashGrid::allocate(uint32_t count, const Reset& reset_array) {
  Slots slots(fingerprints_.memory());
  if (count <= fingerprints_.capacity()) exchange(slots);  // reuses their memory, and so allocates nothing
  slots.reset(count, reset_array);
  exchange(slots);
}

void HashGrid::allocate(uint32_t count) {
  allocate(count, [](auto& array, uint32_t size, const auto& value) { array.assign(size, value); });
}

HashGridView HashGrid::view(const CameraView& camera) {
  keys_ = {camera.position,       camera.cone_width(),      camera.cone_spread(), settings_.cell_size,
           settings_.normal_bins, settings_.direction_bins, settings_.jitter};
  keys_.roughness_bins = settings_.roughness_bins;
  keys_.halved_normals = settings_.undersampled_cells == UndersampledCells::neighbours_coarser;
  counters_before_ = counters();
  if (tally_.read().overflow_count == 0 && overflow_.size() != samples_a_frame_) {
    overflow_.clear();
    overflow_.shrink_to_fit();
    overflow_.reset(samples_a_frame_, kUninitialized);
  }
  return view();
}

HashGridView HashGrid::view() {
  HashGridView v;
  HashGridTally& tally = tally_.mutable_view()[0];
  v.fingerprints = fingerprints_.mutable_view();
  v.bucket_hashes = bucket_hashes_.mutable_view();
  v.parents = parents_.mutable_view();
  v.sums = sums_.mutable_view();
  v.histories = histories_.view();
  v.counters = view_of_one(tally.counters);
  v.overflow = {overflow_.mutable_view(), view_of_one(tally.overflow_count)};
  v.probe_limit =
      std::min(std::max(kMaxProbes, tally_.read().longest + 1), static_cast<uint32_t>(fingerprints_.size()));
  v.renumbered = renumbered_;
  v.keys = keys_;
  v.rule = {static_cast<float>(settings_.max_count), settings_.change_detection,
            static_cast<float>(settings_.min_count), static_cast<uint32_t>(settings_.max_frames)};
  v.undersampled_cells = settings_.undersampled_cells;
  v.coarser_levels = 0;
  if (settings_.undersampled_cells == UndersampledCells::coarser) v.coarser_levels = kCoarserLevels;
  if (settings_.undersampled_cells == UndersampledCells::neighbours_coarser) {
    v.coarser_levels = settings_.coarser_levels;
    v.coarser_probability = kCoarserProbabilityWithNeighbours;
  }
  v.inherited_count = static_cast<float>(settings_.inherited_count);
  v.clamp_factor = settings_.clamp;
  return v;
}

HashGridView HashGrid::placing_view(uint32_t probes) {
  HashGridView v = view();
  v.probe_limit = std::min(probes, static_cast<uint32_t>(fingerprints_.size()));
  v.overflow.samples.size = 0;
  return v;
}

/// Grows the table if its keys fill more than half of it, then adds the waiting samples. The set of waiting samples
/// depends on timing; the number of keys does not.
void HashGrid::settle(Backend& backend) {
  const auto waiting = static_cast<uint32_t>(std::min<size_t>(tally_.read().overflow_count, overflow_.size()));
  const View<const WaitingSample> samples{overflow_.view().data, waiting};
  uint64_t keys = census().taken + counters().made;
  // None of the waiting keys is in the table.
  if (waiting > 0) keys += distinct_keys(backend, "cells", samples, keys_, waiting_keys_);
  if (waiting == 0) waiting_keys_ = Array<uint64_t>(waiting_keys_.memory());
  const uint64_t wanted = std::max(2 * keys, uint64_t{wanted_slots(keys)});
  const auto slots = static_cast<uint32_t>(std::min(wanted, uint64_t{memory_limit_}));
  if (2 * keys > fingerprints_.size() && slots > fingerprints_.size()) rebuild(backend, slots);
  // A table at its memory limit may be full. Probing all of it for each sample would take too long.
  const uint32_t probes = 2 * keys <= memory_limit_ ? kAnywhere : 4 * kMaxProbes;
  if (waiting > 0) {
    const View<uint32_t> longest = view_of_one(tally_.mutable_view()[0].longest);
    launch(backend, "cells", AddWaitingSamplesKernel{samples, placing_view(probes), longest}, kMaintenanceRow,
           rows_of(waiting));
  }
  most_waiting_ = std::max(most_waiting_, uint64_t{waiting});
  tally_.write().overflow_count = 0;
  tally_.write().counters.made = 0;
}

void HashGrid::advance(Backend& backend, bool watched) {
  settle(backend);
  if (counters().inherited_cells > 0) {
    const InheritCellsKernel inherit{view(), histories_.mutable_view()};
    launch(backend, "cells", inherit, kMaintenanceRow, rows_of(fingerprints_.size()));
    inherited_ += counters().inherited_cells;
    tally_.write().counters.inherited_cells = 0;
  }
  reset(backend, "cells", regions_, watched && settings_.change_detection > 0 ? kRegions : 0);
  if (!regions_.empty()) {
    const MeasureChangesKernel measure{view(), regions_.mutable_view()};
    launch(backend, "cells", measure, kMaintenanceRow, rows_of(fingerprints_.size()));
  }
  tally_.write().census = {};
  const MaintainCellsKernel kernel{view(), histories_.mutable_view(), regions_.view(),
                                   view_of_one(tally_.mutable_view()[0].census),
                                   static_cast<uint32_t>(settings_.max_age)};
  launch(backend, "cells", kernel, kMaintenanceRow, rows_of(fingerprints_.size()));
  evicted_ += census().evicted;
}

void HashGrid::abandon_frame() {
  HashGridTally& tally = tally_.write();
  has_abandoned_keys_ = has_abandoned_keys_ || tally.counters.made > counters_before_.made;
  tally.counters = counters_before_;
  tally.overflow_count = 0;
  abandoned_ = true;
}

/// Discards the samples of an abandoned frame and the keys that it inserted.
void HashGrid::drop_frame(Backend& backend) {
  abandoned_ = false;
  fill(backend, "cells", sums_.mutable_view(), CellSums{});
  if (!std::exchange(has_abandoned_keys_, false)) {
    fill(backend, "cells", parents_.mutable_view(), uint32_t{kNoCell});
  } else {
    rebuild(backend, static_cast<uint32_t>(fingerprints_.size()));
    --rebuilds_;  // not counted
  }
}

void HashGrid::adjust_size(Backend& backend) {
  if (abandoned_) drop_frame(backend);
  const uint64_t slots = fingerprints_.size();
  if (census().live > capacity_of(limit_)) discard_oldest(backend, census().live - capacity_of(limit_));
  const HashGridCensus& census = tally_.read().census;
  // Emptied cells keep their slots until a rebuild, because probing stops at gaps.
  const uint32_t wanted = wanted_slots(census.live);
  // Cleaning takes a pass over the table, so it must free at least an eighth of it.
  const bool worthwhile = (census.taken - census.live) * 8 >= slots;
  const bool crowded = census.taken * 2 > slots && (wanted > slots || worthwhile);
  const bool spacious = uint64_t{wanted} * 8 < slots && wanted >= first_slots_;
  if (crowded || spacious || slots > limit_) rebuild(backend, wanted);
  renumbered_ = false;
}

void HashGrid::discard_oldest(Backend& backend, uint64_t count) {
  const KeyedCells cells{fingerprints_.view(), bucket_hashes_.view(), histories_.view()};
  const DiscardKey threshold = discard_threshold(backend, "cells", cells, count, fingerprints_.memory());
  launch(backend, "cells", DiscardCellsKernel{cells, threshold, histories_.mutable_view()}, cells.histories.size, 1, {},
         kFillTile);
  tally_.write().census.live -= count;
  discarded_ += count;
}

void HashGrid::clear(Backend& backend) {
  allocate(first_slots_, in_launches(backend));
  reset_counters();
}

void HashGrid::clear() {
  allocate(first_slots_);
  reset_counters();
}

void HashGrid::reset_counters() {
  tally_.write().census = {};
  tally_.write().overflow_count = 0;
  tally_.write().counters.made = 0;
  renumbered_ = false;
  abandoned_ = has_abandoned_keys_ = false;
}

void HashGrid::rebuild(Backend& backend, uint32_t slots) {
  Slots old(fingerprints_.memory());
  old.reset(slots, in_launches(backend));
  exchange(old);
  const HashGridView target = placing_view(kAnywhere);
  const uint32_t rows = rows_of(old.fingerprints.size());
  const View<uint32_t> longest = view_of_one(tally_.mutable_view()[0].longest);
  const MoveCellsKernel cells{old.fingerprints.view(),
                              old.bucket_hashes.view(),
                              old.sums.view(),
                              old.histories.view(),
                              target,
                              histories_.mutable_view(),
                              longest};
  launch(backend, "cells", cells, kMaintenanceRow, rows);
  if (counters().inherited_cells > 0) {
    const MoveParentsKernel links{old.fingerprints.view(), old.bucket_hashes.view(), old.parents.view(), target};
    launch(backend, "cells", links, kMaintenanceRow, rows);
  }
  tally_.write().census.taken = census().live;
  tally_.write().counters.made = 0;
  renumbered_ = true;
  ++rebuilds_;
}

std::vector<HashGridRecord> HashGrid::records() const {
  const std::span<const uint64_t> fingerprints = fingerprints_.read();
  const std::span<const CellHistory> histories = histories_.read();
  std::vector<uint32_t> slots;
  for (uint32_t slot = 0; slot < fingerprints.size(); ++slot)
    if (fingerprints[slot] != 0 && !histories[slot].empty()) slots.push_back(slot);
  std::sort(slots.begin(), slots.end(), [&](uint32_t a, uint32_t b) { return fingerprints[a] < fingerprints[b]; });
  std::vector<HashGridRecord> records;
  for (const uint32_t slot : slots) {
    const CellHistory& cell = histories[slot];
    records.push_back({{static_cast<uint32_t>(fingerprints[slot]), static_cast<uint32_t>(fingerprints[slot] >> 32)},
                       cell.moments.mean,
                       cell.moments.mean_square,
                       cell.moments.count,
                       cell.age});
  }
  return records;
}

HashGridStatistics HashGrid::statistics() const {
  HashGridStatistics s;
  const auto& [counters, census, overflow_count, longest] = tally_.read();
  s.slots = fingerprints_.size();
  s.cells = census.live;
  s.occupancy = static_cast<float>(census.taken) / static_cast<float>(s.slots);
  s.mean_probes =
      census.taken > 0 ? 1.0f + static_cast<float>(census.displacements) / static_cast<float>(census.taken) : 0.0f;
  s.samples = census.samples;
  s.evicted = evicted_;
  s.discarded = discarded_;
  s.inherited = inherited_;
  s.dropped = counters.dropped;
  s.saturated = counters.saturated;
  s.nonfinite = counters.nonfinite;
  s.skipped_vertices = counters.skipped_vertices;
  s.changed = census.changed;
  s.rebuilds = rebuilds_;
  s.memory_bytes = s.slots * kSlotBytes + most_waiting_ * sizeof(WaitingSample) + waiting_keys_.memory_bytes();
  return s;
}

}  // namespace relume
