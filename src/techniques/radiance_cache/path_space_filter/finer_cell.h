// Cells of half the edge, which a pixel shows where light varies within its ordinary cell ([Binder19] §3.1.3).
#pragma once

#include "techniques/spatial/hash_grid/cell_key.h"

namespace relume {

/// Flag in the layer of finer cells: ordinary cells of their level inherit samples, finer ones do not.
inline constexpr uint16_t kFinerLayer = 0x8000;

/// Offset from `p`, the jittered point of the surface at `position`, to the point of its finer cell, which is jittered
/// half as much. Packed into 10 bits per component, in units of the cell's edge; never 0.
RELUME_HD inline uint32_t finer_offset(const CellKeys& keys, const CellPoint& p, const Vec3& position) {
  const Vec3 offset = (position - p.position) * (0.5f / power_of_two(keys.level_of(p)));
  const auto bits = [](float x) { return math::truncate_to_uint(saturate(x + 0.5f) * 1023.0f + 0.5f); };
  return 1u << 30 | bits(offset.x) << 20 | bits(offset.y) << 10 | bits(offset.z);
}

/// Inputs of the key of the finer cell, which is one level below that of the result.
RELUME_HD inline CellPoint finer_point(const CellKeys& keys, const CellPoint& p, uint32_t offset) {
  const float edge = power_of_two(keys.level_of(p));
  const auto component = [&](int shift) { return static_cast<float>((offset >> shift) & 1023u) / 1023.0f - 0.5f; };
  CellPoint finer = p;
  finer.position += edge * Vec3(component(20), component(10), component(0));
  finer.layer = static_cast<uint16_t>(p.layer | kFinerLayer);
  return finer;
}

}  // namespace relume
