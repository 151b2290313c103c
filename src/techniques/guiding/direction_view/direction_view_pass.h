// Densities of path guiding and of the incident light at one point: two octahedral maps, side by side.
#pragma once

#include "frame/primitives/primitive.h"
#include "techniques/guiding/direction_view/incident_light.h"
#include "techniques/guiding/directional_quadtree/directional_quadtree_pass.h"
#include "techniques/transport/path/path_pass.h"

namespace relume {

inline constexpr BufferKey<float> kDirections{"directions"};

/// Fills the layer "directions" for the first hit of one pixel (`cdq.view-x`, `cdq.view-y`) while `cdq.view` is on. The
/// left half is the quadtree's density over directions. The right half is the density of the incident light times
/// cos θ, without light that next event estimation samples there. Each of its texels traces one path per frame. Both
/// are per steradian with integral 1, so their colours are comparable.
class DirectionViewPass final : public Pass {
 public:
  DirectionViewPass(const DirectionalQuadtreeSettings& settings, const PathSource& source, const OctreePass& octree,
                    Memory& memory);

  void configure(const DirectionalQuadtreeSettings& settings) { settings_ = settings; }
  void configure(const PathSettings& path) { source_.settings = path; }
  PassDeclaration declaration() const override;
  bool run(const FrameContext& frame) override;
  size_t memory_bytes() const override {
    return point_.memory_bytes() + sums_.memory_bytes() + scratch_.memory_bytes();
  }
  void save(std::ostream& out) const override;
  void load(std::istream& in) override;

 private:
  /// Finds the point at the chosen pixel. Returns false if the pixel has no hit.
  bool find_point(const FrameContext& frame, uint32_t pixel);
  /// Traces a path for each direction.
  void trace(const FrameContext& frame, uint32_t edge);
  /// Draws both maps.
  void draw(const FrameContext& frame, uint32_t edge);

  DirectionalQuadtreeSettings settings_;
  PathSource source_;
  const OctreePass& octree_;
  Array<ViewedPoint> point_;  ///< one element, if a view was drawn
  Array<float> sums_;         ///< sums by texel over the frames since the last change
  PrimitiveScratch scratch_;
  uint32_t pixel_ = 0;
};

}  // namespace relume
