// Instructions and special registers that depend on the thread, its warp and its block (PTX ISA 9.7.13, 10).
#pragma once

#include <cstdint>

namespace ptx {

struct Dim {
  uint32_t x = 1;
  uint32_t y = 1;
  uint32_t z = 1;
};

struct Special {
  Dim tid;
  Dim ntid;
  Dim ctaid;
  Dim nctaid;
};

inline constexpr uint32_t kWarpSize = 32;

/// Special registers of the current thread.
const Special& special();
/// Position of the current thread in its warp, and of the warp in its block. Warps follow %tid, x first.
uint32_t laneid();
uint32_t warpid();

inline uint32_t lanemask_eq() { return 1u << laneid(); }
inline uint32_t lanemask_lt() { return lanemask_eq() - 1; }
inline uint32_t lanemask_le() { return lanemask_lt() | lanemask_eq(); }
inline uint32_t lanemask_gt() { return ~lanemask_le(); }
inline uint32_t lanemask_ge() { return ~lanemask_lt(); }

/// Address in the shared memory of the current block.
unsigned char* shared(uint32_t offset);
/// Address of the shared memory whose size the launch gives.
unsigned char* dynamic_shared();

/// Ends the current thread.
[[noreturn]] void exit_thread();
/// Ends the launch with a Fault.
[[noreturn]] void trap_thread();
[[noreturn]] void brkpt_thread();

/// Waits for `count` threads of the block, or for all that have not ended if 0.
void bar_sync(uint32_t barrier, uint32_t count = 0);
/// Waits for the threads of the warp in `members`.
void bar_warp_sync(uint32_t members);

/// Value that a shuffle reads, and whether it is from another thread's range.
struct Shuffled {
  uint32_t value;
  bool valid;
};

/// `value` of the thread at a position relative to the current one. `clamp`: bits 0 to 4 are the last position of a
/// segment, bits 8 to 12 the mask that splits the warp into segments. Where the position is beyond the segment, the
/// thread's own value.
Shuffled shfl_sync_up(uint32_t value, uint32_t distance, uint32_t clamp, uint32_t members);
Shuffled shfl_sync_down(uint32_t value, uint32_t distance, uint32_t clamp, uint32_t members);
Shuffled shfl_sync_bfly(uint32_t value, uint32_t mask, uint32_t clamp, uint32_t members);
Shuffled shfl_sync_idx(uint32_t value, uint32_t position, uint32_t clamp, uint32_t members);

bool vote_sync_all(bool value, uint32_t members);
bool vote_sync_any(bool value, uint32_t members);
/// Whether the value is the same in all members.
bool vote_sync_uni(bool value, uint32_t members);
/// The values of all members, bit by bit; 0 for other threads.
uint32_t vote_sync_ballot(bool value, uint32_t members);

}  // namespace ptx
