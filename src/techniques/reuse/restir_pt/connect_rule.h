// Rules by which two consecutive vertices of a path are connectible: moving the first one to the surface of another
// pixel, and keeping the second, then changes the integrand little.
#pragma once

#include "techniques/reuse/restir_pt/settings.h"
#include "techniques/transport/path/indirect_sample.h"

namespace relume {

/// A vertex at one end of a segment of a path.
struct SegmentEnd {
  float pdf_w = 0;     ///< density of the direction in which the path leaves the vertex, by its BSDF; per steradian
  float alpha = 0;     ///< α of the narrowest glossy lobe of the surface; 1 without any
  float cosine = 0;    ///< |cos| between the segment and the geometric normal
  bool delta = false;  ///< whether the path leaves through a delta lobe
  bool first = false;  ///< whether the vertex is the primary hit
};

/// `bounce`: number of the vertex.
RELUME_HD inline SegmentEnd segment_end(const SurfacePoint& sp, const Vec3& segment, float pdf_w, bool delta,
                                        uint32_t bounce) {
  return {pdf_w, narrowest_alpha(sp.bsdf), std::fabs(glm::dot(sp.ng, segment)), delta, bounce == 0};
}

/// Area at the primary hit over which a uniform direction from the camera spreads, m². `cosine`: |cos| at the hit.
RELUME_HD inline float primary_footprint(float distance, float cosine) {
  return 4.0f * kPi * sqr(distance) / relume::max(cosine, 1e-3f);
}

/// Every test is a property of one path. A shifted path must pass the tests of its source: see PathShifter.
struct ConnectRule {
  /// Largest density of a direction that may be replaced, per steradian: that of RTXDI, 1 / 0.1².
  static constexpr float kLargestDensity = 100;

  PathShiftKind shift = PathShiftKind::hybrid;
  ConnectRuleKind kind = ConnectRuleKind::footprint;
  float least_alpha = 0;      ///< distance_2022
  float least_distance = 0;   ///< distance_2022, metres
  float least_footprint = 0;  ///< footprint, as a fraction of primary_footprint()

  /// Whether `to`, `distance` metres after `from`, can be a joint. `primary`: primary_footprint() of the path.
  RELUME_HD bool connects(const SegmentEnd& from, const SegmentEnd& to, float distance, float primary) const {
    if (to.delta || !connects_to_end(from, to.cosine, distance, primary)) return false;
    if (shift == PathShiftKind::reconnection) return true;
    if (kind == ConnectRuleKind::distance_2022) return to.alpha >= least_alpha;
    // Backwards, the direction that leaves a glossy surface must spread as much; others reflect it everywhere alike.
    return to.alpha >= 1.0f || sqr(distance) >= least_footprint * primary * from.cosine * to.pdf_w;
  }

  /// Whether some shift can keep a direction that leaves vertex `bounce`; otherwise, all shifts repeat its random
  /// numbers. `alpha`: SegmentEnd::alpha of the vertex. `after_delta`: whether the path reached it by a delta lobe.
  RELUME_HD bool may_keep_direction(float alpha, uint32_t bounce, bool after_delta) const {
    switch (shift) {
      case PathShiftKind::replay: return false;
      case PathShiftKind::reconnection: return bounce == 0 || (bounce == 1 && !after_delta);
      case PathShiftKind::hybrid: break;
    }
    return kind != ConnectRuleKind::distance_2022 || alpha >= least_alpha;
  }

  /// Whether the end of a path can be its joint, if `from` samples the direction to it. `cosine`: |cos| at the end.
  /// `distance`: kInfinity for light from infinity. Ends by next event estimation always can. With shift reconnection,
  /// only the second vertex of a path can.
  RELUME_HD bool connects_to_end(const SegmentEnd& from, float cosine, float distance, float primary) const {
    if (from.delta || shift == PathShiftKind::replay) return false;
    if (shift == PathShiftKind::reconnection) return from.first;
    if (kind == ConnectRuleKind::distance_2022) return from.alpha >= least_alpha && distance >= least_distance;
    if (!(from.pdf_w <= kLargestDensity)) return false;
    return distance == kInfinity || sqr(distance) >= least_footprint * primary * cosine * from.pdf_w;
  }
};

}  // namespace relume
