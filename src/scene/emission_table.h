// Sampling tables of triangles whose emission a texture modulates.
#pragma once

#include <span>
#include <vector>

#include "lights/triangle_light.h"
#include "scene/scene_view.h"

namespace relume {

/// Whether a texture modulates the emission, its opacity, or the clearcoat over it.
bool has_textured_emission(const MaterialData& material);

/// A triangle of a mesh with textured emission.
struct EmissiveTriangle {
  const MeshView* mesh = nullptr;
  uint32_t primitive = 0;
};

/// TexturedTriangle without `first_entry`, and its entries; none: the triangle emits nothing.
struct EmissionTable {
  TexturedTriangle triangle{};
  std::vector<AliasEntry> entries;
};

/// Entries that the triangles of one emission texture share, apart from one that each has.
inline constexpr uint32_t kMostEmissionEntries = 1u << 18;

/// Tables whose entries are about a texel large. Where a texture would need more than kMostEmissionEntries, triangles
/// get entries in proportion to their mean luminance times area in texels, whose weights come from mip levels.
/// Materials that glow without an emission texture and have transparent texels are not limited. Every place that is not
/// black can be sampled. Uses all cores.
std::vector<EmissionTable> make_emission_tables(const SceneView& geometry, std::span<const EmissiveTriangle> triangles);

}  // namespace relume
