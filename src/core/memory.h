// Properties of the machine's memory.
#pragma once

#include <cstdint>

namespace relume {

/// Bytes of main memory.
uint64_t physical_memory_bytes();

}  // namespace relume
