#include "instructions/thread.h"

#include <string>

#include "instructions/memory.h"
#include "runtime/block.h"

namespace ptx {
namespace {

/// A shuffle's segment for the current thread: bits 0 to 4 of `clamp` are its last position, bits 8 to 12 the mask.
struct Segment {
  uint32_t first;
  uint32_t last;
};

Segment segment_of(uint32_t clamp) {
  const uint32_t mask = (clamp >> 8) & 31u;
  const uint32_t first = laneid() & mask;
  return {first, first | (clamp & 31u & ~mask)};
}

Shuffled shuffle(uint32_t value, uint32_t source, bool valid, uint32_t members) {
  const uint32_t from = valid ? source : laneid();
  const uint32_t result = Block::current().exchange(value, members)[from];
  if (((members >> from) & 1u) == 0)
    throw Fault("a shuffle reads from lane " + std::to_string(from) + ", which takes no part");
  return {result, valid};
}

}  // namespace

const Special& special() { return Block::current().special(); }
uint32_t laneid() { return Block::current().thread() % kWarpSize; }
uint32_t warpid() { return Block::current().thread() / kWarpSize; }

unsigned char* shared(uint32_t offset) { return Block::current().shared() + offset; }
unsigned char* dynamic_shared() { return Block::current().dynamic_shared(); }

void fail_alignment(const void* address, size_t alignment) {
  throw Fault("address " + std::to_string(reinterpret_cast<uintptr_t>(address)) + " is not a multiple of " +
              std::to_string(alignment));
}

void trap_thread() { throw Fault("trap"); }
void brkpt_thread() { throw Fault("breakpoint"); }

void bar_sync(uint32_t barrier, uint32_t count) {
  if (barrier >= kBarriers) throw Fault("there is no barrier " + std::to_string(barrier));
  if (count % kWarpSize != 0)
    throw Fault("a barrier for " + std::to_string(count) + " threads, which are no whole warps");
  Block::current().wait({Wait::Kind::barrier, barrier, count, 0});
}

void bar_warp_sync(uint32_t members) { Block::current().exchange(0, members); }

Shuffled shfl_sync_up(uint32_t value, uint32_t distance, uint32_t clamp, uint32_t members) {
  const uint32_t lane = laneid();
  distance &= 31u;
  // For this mode, the clamp is the first position that has a source.
  const Segment segment = segment_of(clamp);
  return shuffle(value, lane - distance, lane >= distance && lane - distance >= segment.last, members);
}

Shuffled shfl_sync_down(uint32_t value, uint32_t distance, uint32_t clamp, uint32_t members) {
  const uint32_t source = laneid() + (distance & 31u);
  return shuffle(value, source, source <= segment_of(clamp).last, members);
}

Shuffled shfl_sync_bfly(uint32_t value, uint32_t mask, uint32_t clamp, uint32_t members) {
  const uint32_t source = laneid() ^ (mask & 31u);
  return shuffle(value, source, source <= segment_of(clamp).last, members);
}

Shuffled shfl_sync_idx(uint32_t value, uint32_t position, uint32_t clamp, uint32_t members) {
  const Segment segment = segment_of(clamp);
  const uint32_t source = segment.first | (position & 31u & ~((clamp >> 8) & 31u));
  return shuffle(value, source, source <= segment.last, members);
}

uint32_t vote_sync_ballot(bool value, uint32_t members) {
  const auto values = Block::current().exchange(value ? 1 : 0, members);
  uint32_t ballot = 0;
  for (uint32_t i = 0; i < kWarpSize; ++i) ballot |= (values[i] & (members >> i) & 1u) << i;
  return ballot;
}

bool vote_sync_all(bool value, uint32_t members) { return vote_sync_ballot(value, members) == members; }
bool vote_sync_any(bool value, uint32_t members) { return vote_sync_ballot(value, members) != 0; }
bool vote_sync_uni(bool value, uint32_t members) {
  const uint32_t ballot = vote_sync_ballot(value, members);
  return ballot == members || ballot == 0;
}

}  // namespace ptx
