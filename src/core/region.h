// Regions of space in which techniques learn. Each spatial structure defines its own numbers.
#pragma once

#include <cstdint>

namespace relume {

inline constexpr uint32_t kNoRegion = 0xffffffffu;

}  // namespace relume
