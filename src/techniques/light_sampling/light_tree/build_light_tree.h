// Builds the light tree: binary splits by binned cost over area, orientation and power ([Conty18], §4.3), then nodes of
// eight by pulling up the costliest children.
#pragma once

#include <vector>

#include "techniques/light_sampling/light_tree/light_tree.h"

namespace relume {

/// What LightTree views.
struct LightTreeData {
  std::vector<LightTreeNode> nodes;
  std::vector<LightBounds> bounds;
  std::vector<LightId> lights;
  std::vector<uint32_t> place;
  std::vector<AliasEntry> infinite;

  LightTree view(const LightsView& lights) const;
  size_t memory_bytes() const;
};

/// Bounds of one light at a finite place.
LightBounds bounds_of(const LightsView& lights, LightId id);

/// Lights that emit nothing are left out. Linear in the number of lights, but for a logarithm.
LightTreeData build_light_tree(const LightsView& lights, LightsAtInfinity infinity = LightsAtInfinity::worth_sampling);

}  // namespace relume
