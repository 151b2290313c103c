// Differences between consecutive frames. Buffers declare which changes invalidate their content; histories and caches
// read which content to verify again.
#pragma once

#include <cstdint>

namespace relume {

/// A set of flags.
enum class Change : uint32_t {
  none = 0,
  camera = 1,       ///< position, direction, lens or projection
  geometry = 2,     ///< an instance moved
  lights = 4,       ///< a light moved, or its emission changed
  materials = 8,    ///< the appearance of a surface changed
  settings = 16,    ///< a setting that resets the history
  light_list = 32,  ///< the environment was replaced, or lights were renumbered
  scene = camera | geometry | lights | materials | light_list,
  any = scene | settings,
};

constexpr Change operator|(Change a, Change b) {
  return static_cast<Change>(static_cast<uint32_t>(a) | static_cast<uint32_t>(b));
}
constexpr Change operator&(Change a, Change b) {
  return static_cast<Change>(static_cast<uint32_t>(a) & static_cast<uint32_t>(b));
}
constexpr Change& operator|=(Change& a, Change b) { return a = a | b; }

/// Whether `changes` contains any flag of `wanted`.
constexpr bool includes(Change changes, Change wanted) { return (changes & wanted) != Change::none; }

}  // namespace relume
