// Builds the light tree: binary splits by binned cost over area, orientation and power ([Conty18], §4.3), then nodes of
// eight by opening the costliest children.
#pragma once

#include <vector>

#include "core/array.h"
#include "techniques/light_sampling/light_tree/light_tree.h"

namespace relume {

/// A LightTree on the host.
struct LightTreeData {
  std::vector<LightTreeNode> nodes;
  std::vector<LightBounds> bounds;
  std::vector<LightId> lights;
  std::vector<uint32_t> place;
  std::vector<AliasEntry> infinite;

  LightTree view(const LightsView& lights) const;
};

/// Owns a LightTree for kernels.
class LightTreeArrays {
 public:
  explicit LightTreeArrays(Memory& memory = host_memory())
      : nodes_(memory), bounds_(memory), lights_(memory), place_(memory), infinite_(memory) {}

  void assign(const LightTreeData& data);
  LightTree view(const LightsView& lights) const;
  size_t memory_bytes() const;

 private:
  Array<LightTreeNode> nodes_;
  Array<LightBounds> bounds_;
  Array<LightId> lights_;
  Array<uint32_t> place_;
  Array<AliasEntry> infinite_;
};

/// Bounds of one finite light.
LightBounds bounds_of(const LightsView& lights, LightId id);

/// Builds the tree of all lights with emission, in O(n log n) of their number.
LightTreeData build_light_tree(const LightsView& lights, LightsAtInfinity infinity = LightsAtInfinity::worth_sampling);

}  // namespace relume
