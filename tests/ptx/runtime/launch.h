// Launches kernels of a translated module: their threads run on the calling thread, in shuffled order.
#pragma once

#include <cstddef>
#include <cstdint>

#include "instructions/thread.h"
#include "runtime/module.h"

namespace ptx {

struct Launch {
  Dim grid;                         ///< blocks
  Dim block;                        ///< threads of a block
  size_t dynamic_shared_bytes = 0;  ///< beyond the shared variables of the module
  uint64_t seed = 0;                ///< of the order of blocks and threads
};

/// Most threads of a block.
inline constexpr uint32_t kMaxBlockThreads = 1024;

/// Runs all blocks of a grid. `parameters`: the address of each parameter's value, aligned like its type. Throws Fault;
/// the blocks that ran before keep their effects.
///
/// Threads of cooperative kernels are fibers that run to their next barrier; others run one after the other. Shared
/// memory starts with all bits set, so that reads before writes give NaN. Denormal numbers are kept, whatever the
/// calling thread does with its own.
void run_grid(const Module& module, const Entry& entry, const Launch& launch, void* const* parameters);

/// The same for one block.
void run_block(const Module& module, const Entry& entry, const Launch& launch, void* const* parameters,
               const Dim& block);

}  // namespace ptx
