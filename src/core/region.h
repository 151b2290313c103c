// Regions of space in which techniques learn: numbers that mean something to whoever cuts space up.
#pragma once

#include <cstdint>

namespace relume {

inline constexpr uint32_t kNoRegion = 0xffffffffu;

}  // namespace relume
