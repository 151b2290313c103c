// What guiding knows of one point beside what it should know: two octahedral maps, side by side.
#pragma once

#include "techniques/guiding/directional_quadtree/directional_quadtree_pass.h"
#include "techniques/transport/path/path_pass.h"

namespace relume {

inline constexpr BufferKey<float> kDirections{"directions"};

/// Shows the point at the first hit of one pixel (`cdq.view-x`, `cdq.view-y`), if `cdq.view` asks for it. The left half
/// of the buffer "directions" has the quadtree's density over the directions, the right half that which follows the
/// light that comes in there, without what next event estimation finds. Each texel of the latter traces a path a frame.
/// Both are per steradian, so their colours compare; integrals are 1.
class DirectionViewPass final : public Pass {
 public:
  DirectionViewPass(const DirectionalQuadtreeSettings& settings, const PathSource& source, const OctreePass& octree)
      : settings_(settings), source_(source), octree_(octree) {}

  void configure(const DirectionalQuadtreeSettings& settings) { settings_ = settings; }
  void configure(const PathSettings& path) { source_.settings = path; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  size_t memory_bytes() const override { return sums_.size() * sizeof(float); }
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

 private:
  DirectionalQuadtreeSettings settings_;
  PathSource source_;
  const OctreePass& octree_;
  std::vector<float> sums_;  ///< of what the texels' paths found since the point was chosen
  uint32_t pixel_ = 0;
};

}  // namespace relume
