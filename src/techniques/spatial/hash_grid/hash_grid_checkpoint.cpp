// Checkpoints of the hash grid.
#include <algorithm>
#include <cstring>
#include <vector>

#include "techniques/spatial/hash_grid/hash_grid_table.h"

namespace relume {
namespace {

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

/// A checkpoint has the number of slots, counters and all cells.
constexpr size_t kSavedHeaderBytes = sizeof(uint32_t) + sizeof(HashGridCounters) + 4 * sizeof(uint64_t);
constexpr size_t kSavedCellBytes = sizeof(uint64_t) + sizeof(uint32_t) + sizeof(CellHistory);

struct SavedCell {
  CellAddress address;
  CellHistory history;
};

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

std::vector<std::byte> HashGrid::save() const {
  const std::span<const uint64_t> fingerprints = fingerprints_.read();
  const std::span<const uint32_t> bucket_hashes = bucket_hashes_.read();
  const std::span<const CellHistory> histories = histories_.read();
  // Cells without a history were inserted by an abandoned frame or evicted.
  const auto is_saved = [&](size_t i) {
    return fingerprints[i] != 0 && !(has_abandoned_keys_ && histories[i].empty());
  };
  size_t cells = 0;
  for (size_t i = 0; i < fingerprints.size(); ++i) cells += is_saved(i) ? 1 : 0;
  std::vector<std::byte> bytes(kSavedHeaderBytes + cells * kSavedCellBytes);
  std::span<std::byte> rest = bytes;
  put(rest, static_cast<uint32_t>(fingerprints.size()));
  put(rest, expected_cells_);
  put(rest, counters());
  put(rest, evicted_);
  put(rest, discarded_);
  put(rest, inherited_);
  for (size_t i = 0; i < fingerprints.size(); ++i) {
    if (!is_saved(i)) continue;
    put(rest, fingerprints[i]);
    put(rest, bucket_hashes[i]);
    put(rest, histories[i]);
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
  evicted_ = evicted;
  discarded_ = discarded;
  inherited_ = inherited;
  HashGridTally& tally = tally_.write();
  tally.counters = counters;
  const HashGridView v = placing_view(kNoCell);
  fingerprints_.write();  // find_or_insert() accesses them on the host
  bucket_hashes_.write();
  const std::span<CellHistory> histories = histories_.write();
  for (const SavedCell& cell : cells) {
    const uint32_t slot = v.find_or_insert(cell.address);
    histories[slot] = cell.history;
    tally.longest = std::max(tally.longest, v.displacement(cell.address, slot));
    ++tally.census.taken;
    tally.census.live += cell.history.empty() ? 0u : 1u;
  }
  tally.counters.made = 0;
  return true;
}

}  // namespace relume
