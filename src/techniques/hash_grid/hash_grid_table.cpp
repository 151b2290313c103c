#include "techniques/hash_grid/hash_grid_table.h"

#include <algorithm>
#include <cstring>

namespace relume {
namespace {

/// Slots for each cell that is expected. adjust_size() keeps the table at most half full, so that probing stays short.
constexpr uint64_t kSlotsPerCell = 4;
constexpr uint32_t kMinSlots = 1024;

constexpr uint64_t kSlotBytes = sizeof(uint64_t) + 2 * sizeof(uint32_t) + sizeof(CellSums) + sizeof(CellHistory);

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

/// What goes into a checkpoint: the number of slots, counters, and each cell.
constexpr size_t kSavedHeaderBytes = sizeof(uint32_t) + sizeof(HashGridCounters) + 3 * sizeof(uint64_t);
constexpr size_t kSavedCellBytes = sizeof(uint64_t) + sizeof(uint32_t) + sizeof(CellHistory);

}  // namespace

uint64_t open_slot_limit(uint64_t pixels, uint64_t depths, uint64_t memory_bytes) {
  const uint64_t wanted = std::max(pixels * depths * kSlotsPerCell, uint64_t{1} << 20);
  return std::clamp(memory_bytes / 8 / kSlotBytes, uint64_t{kMinSlots}, std::min(wanted, uint64_t{kMostSlots}));
}

HashGrid::HashGrid(const HashGridSettings& settings, uint64_t expected_cells, uint64_t open_limit)
    : expected_cells_(std::min(expected_cells, uint64_t{kMostSlots})) {
  configure(settings, open_limit);
  allocate(first_slots_);
}

void HashGrid::configure(const HashGridSettings& settings, uint64_t open_limit) {
  settings_ = settings;
  const uint64_t limit = settings.max_cells > 0 ? static_cast<uint64_t>(settings.max_cells) : open_limit;
  limit_ = static_cast<uint32_t>(std::clamp(limit, uint64_t{1}, uint64_t{kMostSlots}));
  first_slots_ = wanted_slots(expected_cells_);
}

uint32_t HashGrid::wanted_slots(uint64_t live) const {
  return static_cast<uint32_t>(std::min(std::max(live * kSlotsPerCell, uint64_t{kMinSlots}), uint64_t{limit_}));
}

void HashGrid::allocate(uint32_t slots) {
  fingerprints_.assign(slots, 0);
  homes_.assign(slots, 0);
  parents_.assign(slots, kNoCell);
  sums_.assign(slots, {});
  histories_.assign(slots, {});
}

HashGridView HashGrid::view(const CameraView& camera) {
  HashGridView v;
  v.fingerprints = mutable_view_of(fingerprints_);
  v.homes = mutable_view_of(homes_);
  v.parents = mutable_view_of(parents_);
  v.sums = mutable_view_of(sums_);
  v.histories = view_of(histories_);
  v.counters = &counters_;
  v.keys = {camera.position,       camera.cone_width(),      camera.cone_spread(), settings_.cell_size,
            settings_.normal_bins, settings_.direction_bins, settings_.jitter};
  v.rule = {static_cast<float>(settings_.max_count), settings_.change_detection,
            static_cast<float>(settings_.min_count)};
  v.thin_cells = settings_.thin_cells;
  v.inherited_count = static_cast<float>(settings_.inherited_count);
  v.clamp_factor = settings_.clamp;
  return v;
}

void HashGrid::advance(Backend& backend, bool watched) {
  if (counters_.heirs > 0) {
    const InheritCellsKernel inherit{view({}), mutable_view_of(histories_)};
    launch(backend, "cells", inherit, kMaintenanceRow, rows_of(fingerprints_.size()));
    inherited_ += counters_.heirs;
    counters_.heirs = 0;
  }
  regions_.assign(watched && settings_.change_detection > 0 ? kRegions : 0, {});
  if (!regions_.empty()) {
    const MeasureChangesKernel measure{view({}), mutable_view_of(regions_)};
    launch(backend, "cells", measure, kMaintenanceRow, rows_of(fingerprints_.size()));
  }
  census_ = {};
  const MaintainCellsKernel kernel{view({}), mutable_view_of(histories_), view_of(regions_), &census_,
                                   static_cast<uint32_t>(settings_.max_age)};
  launch(backend, "cells", kernel, kMaintenanceRow, rows_of(fingerprints_.size()));
  evicted_ += census_.evicted;
}

void HashGrid::adjust_size(Backend& backend) {
  // Emptied cells keep their slots, or probing would stop at the gaps, until a rebuild.
  const uint64_t slots = fingerprints_.size();
  const uint32_t wanted = wanted_slots(census_.live);
  // Cleaning takes a pass over the table: it has to free some of it, and less if new cells find no room.
  const uint64_t dead = census_.taken - census_.live;
  const bool lost = counters_.dropped > dropped_before_;
  const bool worthwhile = dead * (lost ? 64 : 8) >= slots;
  const bool crowded = census_.taken * 2 > slots && (wanted > slots || worthwhile);
  const bool spacious = uint64_t{wanted} * 8 < slots && wanted >= first_slots_;
  if (crowded || spacious || slots > limit_) rebuild(backend, wanted);
  dropped_before_ = counters_.dropped;
}

void HashGrid::clear() {
  allocate(first_slots_);
  census_ = {};
}

void HashGrid::rebuild(Backend& backend, uint32_t slots) {
  std::vector<uint64_t> fingerprints(slots, 0);
  std::vector<uint32_t> homes(slots, 0);
  std::vector<CellHistory> histories(slots);
  fingerprints.swap(fingerprints_);
  homes.swap(homes_);
  histories.swap(histories_);
  sums_.assign(slots, {});
  parents_.assign(slots, kNoCell);
  const MoveCellsKernel kernel{view_of(fingerprints), view_of(homes), view_of(histories), view({}),
                               mutable_view_of(histories_)};
  launch(backend, "cells", kernel, kMaintenanceRow, rows_of(fingerprints.size()));
  census_.taken = census_.live;
  ++rebuilds_;
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
  s.inherited = inherited_;
  s.dropped = counters_.dropped;
  s.saturated = counters_.saturated;
  s.nonfinite = counters_.nonfinite;
  s.unfed = counters_.unfed;
  s.changed = census_.changed;
  s.rebuilds = rebuilds_;
  s.memory_bytes = s.slots * kSlotBytes;
  return s;
}

std::vector<std::byte> HashGrid::save() const {
  const auto taken =
      fingerprints_.size() - static_cast<size_t>(std::count(fingerprints_.begin(), fingerprints_.end(), 0u));
  std::vector<std::byte> bytes(kSavedHeaderBytes + taken * kSavedCellBytes);
  std::span<std::byte> rest = bytes;
  put(rest, static_cast<uint32_t>(fingerprints_.size()));
  put(rest, expected_cells_);
  put(rest, counters_);
  put(rest, evicted_);
  put(rest, inherited_);
  for (size_t i = 0; i < fingerprints_.size(); ++i) {
    if (fingerprints_[i] == 0) continue;
    put(rest, fingerprints_[i]);
    put(rest, homes_[i]);
    put(rest, histories_[i]);
  }
  return bytes;
}

bool HashGrid::load(std::span<const std::byte> bytes) {
  if (bytes.size() < kSavedHeaderBytes || (bytes.size() - kSavedHeaderBytes) % kSavedCellBytes != 0) return false;
  const size_t cells = (bytes.size() - kSavedHeaderBytes) / kSavedCellBytes;
  const auto slots = take<uint32_t>(bytes);
  const auto expected_cells = take<uint64_t>(bytes);
  if (slots == 0 || slots > uint32_t{kMostSlots} || cells > slots || expected_cells > uint64_t{kMostSlots})
    return false;
  expected_cells_ = expected_cells;
  first_slots_ = wanted_slots(expected_cells_);
  allocate(std::min(slots, limit_));
  counters_ = take<HashGridCounters>(bytes);
  evicted_ = take<uint64_t>(bytes);
  inherited_ = take<uint64_t>(bytes);
  census_ = {};
  const HashGridView v = view({});
  for (size_t i = 0; i < cells; ++i) {
    const auto fingerprint = take<uint64_t>(bytes);
    const auto home = take<uint32_t>(bytes);
    const auto history = take<CellHistory>(bytes);
    bool made = false;
    const uint32_t slot = v.find_or_insert({fingerprint, home}, made);
    if (slot == kNoCell) {
      ++counters_.dropped;
      continue;
    }
    histories_[slot] = history;
    ++census_.taken;
    census_.live += history.empty() ? 0u : 1u;
  }
  dropped_before_ = counters_.dropped;
  return true;
}

}  // namespace relume
