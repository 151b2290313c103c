// Sampling tables of triangles with textured emission.
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

/// TexturedTriangle without `first_entry`, and its entries. No entries: the triangle emits nothing.
struct EmissionTable {
  TexturedTriangle triangle{};
  std::vector<AliasEntry> entries;
};

/// Maximum number of entries shared by the triangles of one emission texture, besides one entry per triangle.
inline constexpr uint32_t kMostEmissionEntries = 1u << 18;

/// Builds tables with entries of about one texel. If a texture needs more than kMostEmissionEntries, its triangles get
/// entries in proportion to their mean luminance times area in texels. The weights then come from mip levels. Emissive
/// materials with transparent texels but without an emission texture are not limited. Every non-black position can be
/// sampled. Uses all cores.
std::vector<EmissionTable> make_emission_tables(const SceneView& geometry, std::span<const EmissiveTriangle> triangles);

}  // namespace relume
