// New states of Markov chains, recorded by paths at fixed addresses. Afterwards each cell takes one of the states that
// were recorded for it, chosen by a hash, so the result does not depend on the order of threads.
#pragma once

#include "core/fixed_point.h"
#include "techniques/spatial/markov_grid/markov_grid.h"

namespace relume {

/// A state and the cells that may take it; kNoSlot: none.
template <typename ChainState>
struct MarkovRecord {
  ChainState state;
  MarkovCell cells[2];
};

/// Records of a frame: that of vertex v at pixel p is element v · pixels + p.
template <typename ChainState>
struct MarkovRecords {
  View<MarkovRecord<ChainState>> records;
  uint32_t vertices = 0;  ///< per path, at most kMostChainVertices; 0: nothing is recorded
  uint32_t pixels = 0;

  RELUME_HD MarkovRecord<ChainState>& record(uint32_t vertex, uint32_t pixel) const {
    return records[vertex * pixels + pixel];
  }
  RELUME_HD void clear(uint32_t vertex, uint32_t pixel) const {
    record(vertex, pixel).cells[0] = {};
    record(vertex, pixel).cells[1] = {};
  }
  /// Clears the records of a pixel.
  RELUME_HD void skip(uint32_t pixel) const {
    for (uint32_t v = 0; v < vertices; ++v) clear(v, pixel);
  }
};

/// Order of the records of one slot: the least key wins. Keys of later frames are less than all earlier
/// ones, so winners need not be cleared between frames.
struct MarkovPriority {
  static constexpr uint64_t kNone = ~uint64_t{0};
  static constexpr uint32_t kMostStamp = 0xfffe;

  uint32_t stamp = 0;  ///< number of the frame since all winners were kNone, 1 … kMostStamp
  uint32_t seed = 0;   ///< different in each frame

  RELUME_HD uint64_t key(uint32_t record) const {
    const uint64_t frame = uint64_t{0xffff - stamp} << 48;
    return frame | uint64_t{hash(seed, record) >> 16} << 32 | record;
  }
};

/// Finds the record that writes each cell.
template <typename ChainState>
struct ElectWritersKernel {
  View<const MarkovRecord<ChainState>> records;
  View<uint64_t> winners;  ///< key by slot
  MarkovPriority priority;

  RELUME_HD void operator()(uint32_t record, uint32_t) const {
    for (const MarkovCell& cell : records[record].cells) {
      if (cell.slot < winners.size) atomic_min(&winners[cell.slot], priority.key(record));
    }
  }
};

/// Writes the states of the elected records: at most one for each slot.
template <typename ChainState>
struct WriteStatesKernel {
  View<const MarkovRecord<ChainState>> records;
  View<const uint64_t> winners;
  View<MarkovSlot<ChainState>> slots;
  MarkovPriority priority;

  RELUME_HD void operator()(uint32_t record, uint32_t) const {
    for (const MarkovCell& cell : records[record].cells) {
      if (cell.slot >= winners.size || winners[cell.slot] != priority.key(record)) continue;
      slots[cell.slot] = {records[record].state, cell.check};
    }
  }
};

}  // namespace relume
