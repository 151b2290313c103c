#include "techniques/spatial/hash_grid/hash_grid_table.h"

#include <algorithm>
#include <cstring>
#include <tuple>
#include <utility>

namespace relume {
namespace {

/// Slots per expected cell. adjust_size() keeps the table at most half full, so that probing stays short.
constexpr uint64_t kSlotsPerCell = 4;
constexpr uint32_t kMinSlots = 1024;

constexpr uint64_t kSlotBytes = sizeof(uint64_t) + 2 * sizeof(uint32_t) + sizeof(CellSums) + sizeof(CellHistory);

/// Probes all slots.
constexpr uint32_t kAnywhere = kNoCell;

uint32_t rows_of(size_t slots) { return static_cast<uint32_t>((slots + kMaintenanceRow - 1) / kMaintenanceRow); }

template <typename T>
void put(std::span<std::byte>& bytes, const T& value) {
  std::memcpy(bytes.data(), &value, sizeof(T));
  bytes = bytes.subspan(sizeof(T));
}

template <typename T>
T take(std::span<const std::byte>& bytes) {
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  bytes = bytes.subspan(sizeof(T));
  return value;
}

/// Maximum number of cells between frames: seven eighths of the slots, so that probing ends.
uint64_t capacity_of(uint32_t slots) { return std::max<uint64_t>(1, uint64_t{slots} * 7 / 8); }

/// A checkpoint has the number of slots, counters and all cells.
constexpr size_t kSavedHeaderBytes = sizeof(uint32_t) + sizeof(HashGridCounters) + 4 * sizeof(uint64_t);
constexpr size_t kSavedCellBytes = sizeof(uint64_t) + sizeof(uint32_t) + sizeof(CellHistory);

struct SavedCell {
  CellAddress address;
  CellHistory history;
};

/// Number of distinct keys of waiting samples. None of them is in the table.
uint64_t distinct_keys(const View<const WaitingSample>& samples, const CellKeys& keys) {
  std::vector<uint64_t> fingerprints(samples.size);
  for (uint32_t i = 0; i < samples.size; ++i)
    fingerprints[i] = keys.address(samples[i].point, samples[i].coarser).fingerprint;
  std::sort(fingerprints.begin(), fingerprints.end());
  return static_cast<uint64_t>(std::unique(fingerprints.begin(), fingerprints.end()) - fingerprints.begin());
}

/// The cells after the header of a checkpoint; empty if any is invalid.
std::vector<SavedCell> read_cells(std::span<const std::byte> bytes) {
  std::vector<SavedCell> cells(bytes.size() / kSavedCellBytes);
  for (SavedCell& cell : cells) {
    cell.address.fingerprint = take<uint64_t>(bytes);
    cell.address.bucket_hash = take<uint32_t>(bytes);
    cell.history = take<CellHistory>(bytes);
    if (cell.address.fingerprint == 0 || !is_finite(cell.history.moments.count)) return {};
  }
  std::vector<uint64_t> fingerprints;
  for (const SavedCell& cell : cells) fingerprints.push_back(cell.address.fingerprint);
  std::sort(fingerprints.begin(), fingerprints.end());
  const bool unique = std::adjacent_find(fingerprints.begin(), fingerprints.end()) == fingerprints.end();
  return unique ? cells : std::vector<SavedCell>{};
}

}  // namespace

HashGridBounds bounds_for(uint64_t pixels, uint64_t depths, uint64_t memory_bytes) {
  const uint64_t in_memory = std::clamp(memory_bytes / 8 / kSlotBytes, uint64_t{kMinSlots}, uint64_t{kMostSlots});
  const uint64_t wanted = std::max(pixels * depths * kSlotsPerCell, uint64_t{1} << 20);
  // One sample in eight is added to a coarser cell, too.
  return {std::min(wanted, in_memory), in_memory, pixels * depths * 5 / 4 + kMinSlots};
}

HashGrid::HashGrid(const HashGridSettings& settings, uint64_t expected_cells, const HashGridBounds& bounds)
    : expected_cells_(std::min(expected_cells, uint64_t{kMostSlots})) {
  configure(settings, bounds);
  allocate(first_slots_);
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

void HashGrid::allocate(uint32_t slots) {
  fingerprints_.assign(slots, 0);
  bucket_hashes_.assign(slots, 0);
  parents_.assign(slots, kNoCell);
  sums_.assign(slots, {});
  histories_.assign(slots, {});
  longest_ = 0;
}

HashGridView HashGrid::view(const CameraView& camera) {
  keys_ = {camera.position,       camera.cone_width(),      camera.cone_spread(), settings_.cell_size,
           settings_.normal_bins, settings_.direction_bins, settings_.jitter};
  counters_before_ = counters_;
  if (overflow_count_ == 0 && overflow_capacity_ != samples_a_frame_) {
    overflow_.reset(new std::byte[samples_a_frame_ * sizeof(WaitingSample)]);
    overflow_capacity_ = samples_a_frame_;
  }
  return view();
}

HashGridView HashGrid::view() {
  HashGridView v;
  v.fingerprints = mutable_view_of(fingerprints_);
  v.bucket_hashes = mutable_view_of(bucket_hashes_);
  v.parents = mutable_view_of(parents_);
  v.sums = mutable_view_of(sums_);
  v.histories = view_of(histories_);
  v.counters = &counters_;
  v.overflow = {{reinterpret_cast<WaitingSample*>(overflow_.get()), static_cast<uint32_t>(overflow_capacity_)},
                &overflow_count_};
  v.probe_limit = std::min(std::max(kMaxProbes, longest_ + 1), static_cast<uint32_t>(fingerprints_.size()));
  v.renumbered = renumbered_;
  v.keys = keys_;
  v.rule = {static_cast<float>(settings_.max_count), settings_.change_detection,
            static_cast<float>(settings_.min_count)};
  v.undersampled_cells = settings_.undersampled_cells;
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
  const auto waiting = static_cast<uint32_t>(std::min(uint64_t{overflow_count_}, overflow_capacity_));
  const View<const WaitingSample> samples{reinterpret_cast<const WaitingSample*>(overflow_.get()), waiting};
  const uint64_t keys = census_.taken + counters_.made + distinct_keys(samples, keys_);
  const uint64_t wanted = std::max(2 * keys, uint64_t{wanted_slots(keys)});
  const auto slots = static_cast<uint32_t>(std::min(wanted, uint64_t{memory_limit_}));
  if (2 * keys > fingerprints_.size() && slots > fingerprints_.size()) rebuild(backend, slots);
  // A table at its memory limit may be full. Probing all of it for each sample would take too long.
  const uint32_t probes = 2 * keys <= memory_limit_ ? kAnywhere : 4 * kMaxProbes;
  if (waiting > 0) {
    launch(backend, "cells", AddWaitingSamplesKernel{samples, placing_view(probes), &longest_}, kMaintenanceRow,
           rows_of(waiting));
  }
  most_waiting_ = std::max(most_waiting_, uint64_t{waiting});
  overflow_count_ = 0;
  counters_.made = 0;
}

void HashGrid::advance(Backend& backend, bool watched) {
  settle(backend);
  if (counters_.inherited_cells > 0) {
    const InheritCellsKernel inherit{view(), mutable_view_of(histories_)};
    launch(backend, "cells", inherit, kMaintenanceRow, rows_of(fingerprints_.size()));
    inherited_ += counters_.inherited_cells;
    counters_.inherited_cells = 0;
  }
  regions_.assign(watched && settings_.change_detection > 0 ? kRegions : 0, {});
  if (!regions_.empty()) {
    const MeasureChangesKernel measure{view(), mutable_view_of(regions_)};
    launch(backend, "cells", measure, kMaintenanceRow, rows_of(fingerprints_.size()));
  }
  census_ = {};
  const MaintainCellsKernel kernel{view(), mutable_view_of(histories_), view_of(regions_), &census_,
                                   static_cast<uint32_t>(settings_.max_age)};
  launch(backend, "cells", kernel, kMaintenanceRow, rows_of(fingerprints_.size()));
  evicted_ += census_.evicted;
}

void HashGrid::abandon_frame() {
  has_abandoned_keys_ = has_abandoned_keys_ || counters_.made > counters_before_.made;
  counters_ = counters_before_;
  overflow_count_ = 0;
  abandoned_ = true;
}

/// Discards the samples of an abandoned frame and the keys that it inserted.
void HashGrid::drop_frame(Backend& backend) {
  abandoned_ = false;
  std::fill(sums_.begin(), sums_.end(), CellSums{});
  if (!std::exchange(has_abandoned_keys_, false)) return std::fill(parents_.begin(), parents_.end(), kNoCell);
  rebuild(backend, static_cast<uint32_t>(fingerprints_.size()));
  --rebuilds_;  // not counted
}

void HashGrid::adjust_size(Backend& backend) {
  if (abandoned_) drop_frame(backend);
  const uint64_t slots = fingerprints_.size();
  if (census_.live > capacity_of(limit_)) discard_oldest(census_.live - capacity_of(limit_));
  // Emptied cells keep their slots until a rebuild, because probing stops at gaps.
  const uint32_t wanted = wanted_slots(census_.live);
  // Cleaning takes a pass over the table, so it must free at least an eighth of it.
  const bool worthwhile = (census_.taken - census_.live) * 8 >= slots;
  const bool crowded = census_.taken * 2 > slots && (wanted > slots || worthwhile);
  const bool spacious = uint64_t{wanted} * 8 < slots && wanted >= first_slots_;
  if (crowded || spacious || slots > limit_) rebuild(backend, wanted);
  renumbered_ = false;
}

void HashGrid::discard_oldest(uint64_t count) {
  std::vector<uint32_t> cells;
  for (uint32_t i = 0; i < histories_.size(); ++i) {
    if (!histories_[i].empty()) cells.push_back(i);
  }
  // A total order, so the choice does not depend on slots.
  const auto rank = [&](uint32_t i) {
    return std::tuple(histories_[i].age, -histories_[i].moments.count, fingerprints_[i], bucket_hashes_[i]);
  };
  const auto first = cells.end() - static_cast<std::ptrdiff_t>(count);
  std::nth_element(cells.begin(), first, cells.end(), [&](uint32_t a, uint32_t b) { return rank(a) < rank(b); });
  for (auto i = first; i != cells.end(); ++i) histories_[*i] = {};
  census_.live -= count;
  discarded_ += count;
}

void HashGrid::clear() {
  allocate(first_slots_);
  census_ = {};
  overflow_count_ = 0;
  counters_.made = 0;
  renumbered_ = false;
  abandoned_ = has_abandoned_keys_ = false;
}

void HashGrid::rebuild(Backend& backend, uint32_t slots) {
  std::vector<uint64_t> fingerprints(slots, 0);
  std::vector<uint32_t> bucket_hashes(slots, 0);
  std::vector<uint32_t> parents(slots, kNoCell);
  std::vector<CellSums> sums(slots);
  std::vector<CellHistory> histories(slots);
  fingerprints.swap(fingerprints_);
  bucket_hashes.swap(bucket_hashes_);
  parents.swap(parents_);
  sums.swap(sums_);
  histories.swap(histories_);
  longest_ = 0;
  const HashGridView target = placing_view(kAnywhere);
  const uint32_t rows = rows_of(fingerprints.size());
  const MoveCellsKernel cells{view_of(fingerprints),
                              view_of(bucket_hashes),
                              view_of(sums),
                              view_of(histories),
                              target,
                              mutable_view_of(histories_),
                              &longest_};
  launch(backend, "cells", cells, kMaintenanceRow, rows);
  if (counters_.inherited_cells > 0) {
    const MoveParentsKernel links{view_of(fingerprints), view_of(bucket_hashes), view_of(parents), target};
    launch(backend, "cells", links, kMaintenanceRow, rows);
  }
  census_.taken = census_.live;
  counters_.made = 0;
  renumbered_ = true;
  ++rebuilds_;
}

std::vector<HashGridRecord> HashGrid::records() const {
  std::vector<uint32_t> slots;
  for (uint32_t slot = 0; slot < fingerprints_.size(); ++slot) {
    if (fingerprints_[slot] != 0 && !histories_[slot].empty()) slots.push_back(slot);
  }
  std::sort(slots.begin(), slots.end(), [&](uint32_t a, uint32_t b) { return fingerprints_[a] < fingerprints_[b]; });
  std::vector<HashGridRecord> records;
  for (const uint32_t slot : slots) {
    const CellHistory& cell = histories_[slot];
    const uint64_t key = fingerprints_[slot];
    records.push_back({{static_cast<uint32_t>(key), static_cast<uint32_t>(key >> 32)},
                       cell.moments.mean,
                       cell.moments.mean_square,
                       cell.moments.count,
                       cell.age});
  }
  return records;
}

HashGridStatistics HashGrid::statistics() const {
  HashGridStatistics s;
  s.slots = fingerprints_.size();
  s.cells = census_.live;
  s.occupancy = static_cast<float>(census_.taken) / static_cast<float>(s.slots);
  s.mean_probes =
      census_.taken > 0 ? 1.0f + static_cast<float>(census_.displacements) / static_cast<float>(census_.taken) : 0.0f;
  s.samples = census_.samples;
  s.evicted = evicted_;
  s.discarded = discarded_;
  s.inherited = inherited_;
  s.dropped = counters_.dropped;
  s.saturated = counters_.saturated;
  s.nonfinite = counters_.nonfinite;
  s.skipped_vertices = counters_.skipped_vertices;
  s.changed = census_.changed;
  s.rebuilds = rebuilds_;
  s.memory_bytes = s.slots * kSlotBytes + most_waiting_ * sizeof(WaitingSample);
  return s;
}

std::vector<std::byte> HashGrid::save() const {
  // Cells without a history were inserted by an abandoned frame or evicted.
  const auto is_saved = [&](size_t i) {
    return fingerprints_[i] != 0 && !(has_abandoned_keys_ && histories_[i].empty());
  };
  size_t cells = 0;
  for (size_t i = 0; i < fingerprints_.size(); ++i) cells += is_saved(i) ? 1 : 0;
  std::vector<std::byte> bytes(kSavedHeaderBytes + cells * kSavedCellBytes);
  std::span<std::byte> rest = bytes;
  put(rest, static_cast<uint32_t>(fingerprints_.size()));
  put(rest, expected_cells_);
  put(rest, counters_);
  put(rest, evicted_);
  put(rest, discarded_);
  put(rest, inherited_);
  for (size_t i = 0; i < fingerprints_.size(); ++i) {
    if (!is_saved(i)) continue;
    put(rest, fingerprints_[i]);
    put(rest, bucket_hashes_[i]);
    put(rest, histories_[i]);
  }
  return bytes;
}

bool HashGrid::load(std::span<const std::byte> bytes) {
  if (bytes.size() < kSavedHeaderBytes || (bytes.size() - kSavedHeaderBytes) % kSavedCellBytes != 0) return false;
  const size_t count = (bytes.size() - kSavedHeaderBytes) / kSavedCellBytes;
  const auto slots = take<uint32_t>(bytes);
  const auto expected_cells = take<uint64_t>(bytes);
  if (slots == 0 || slots > uint32_t{kMostSlots} || count > slots || expected_cells > uint64_t{kMostSlots})
    return false;
  const auto counters = take<HashGridCounters>(bytes);
  const auto evicted = take<uint64_t>(bytes);
  const auto discarded = take<uint64_t>(bytes);
  const auto inherited = take<uint64_t>(bytes);
  const std::vector<SavedCell> cells = read_cells(bytes);
  if (cells.size() != count) return false;
  expected_cells_ = expected_cells;
  first_slots_ = wanted_slots(expected_cells_);
  clear();
  allocate(std::max(std::min(slots, limit_), static_cast<uint32_t>(std::min(2 * count, size_t{kMostSlots}))));
  counters_ = counters;
  evicted_ = evicted;
  discarded_ = discarded;
  inherited_ = inherited;
  const HashGridView v = placing_view(kAnywhere);
  for (const SavedCell& cell : cells) {
    const uint32_t slot = v.find_or_insert(cell.address);
    histories_[slot] = cell.history;
    longest_ = std::max(longest_, v.displacement(cell.address, slot));
    ++census_.taken;
    census_.live += cell.history.empty() ? 0u : 1u;
  }
  counters_.made = 0;
  return true;
}

}  // namespace relume
