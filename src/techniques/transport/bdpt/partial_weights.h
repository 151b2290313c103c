// Multiple importance sampling weights of bidirectional path tracing, computed along the subpaths.
//
// A path x0 … xk can be sampled with s vertices from the light and t = k + 1 − s from the camera. With the power
// heuristic (β = 2, [Veach97] eq. 9.13), strategy s has the weight 1 / Σ_j (p_j / p_s)². At the end of a subpath x0 …
// xi, the terms of all strategies with a shorter subpath sum to
//
//     (←p_i)² · (A_i + (←σ_i)² B_i)
//
//     A_i = v_i / (→p_i)²                                       the strategy that cuts between x(i−1) and xi
//     B_i = (←g_(i−1) / →p_i)² · (A_(i−1) + (←σ_(i−1))² B_(i−1))   earlier cuts
//
// →p: density per area with which the subpath found a vertex; ←p: that of the subpath from the other side.
// ←σ_i: density per solid angle with which the other side continues from xi to x(i−1).
// ←g_(i−1) = cos / d²: converts ←σ_i to a density per area at x(i−1).
// v_i: 1 if both ends of the cut can be connected (no delta scattering), else 0.
//
// Only ←p_i and ←σ_i depend on the other end of a connection, so a vertex carries only A and B. The quantities of
// [Antwerpen11] and [Georgiev12] follow the same idea in other groupings.
//
// At a delta scattering, the densities of both directions are the same Dirac pulse, up to the probability of the lobe
// and the Jacobian of refraction. A_i vanishes on both sides of the vertex, and this factor replaces ←σ in B.
//
// Vertex merging ([Georgiev12]) adds a strategy per surface vertex xi without delta scattering: subpaths from both
// sides find it, and n light subpaths within a radius r count. Its density is that of the cut behind xi times ←p_i η,
// with η = π r² n. It adds η² beside A_i, at the end of the subpath and in B. See techniques/transport/vcm.
//
// Lights at infinity (and orthographic cameras) have directions instead of positions. Their x0 is measured per solid
// angle. x1 then has a density per area facing that direction, without a distance.
#pragma once

#include "core/vec.h"

namespace relume {

/// Returns factor · value, and 0 for factor 0 even if value overflowed to infinity, as in scenes of enormous extent.
RELUME_HD inline float zero_or(float factor, float value) { return factor > 0.0f ? factor * value : 0.0f; }

/// Part of a weight that depends on one end of a subpath only.
struct PartialWeights {
  float a;
  float b;

  /// Sum over all strategies with a shorter subpath. `p` = ←p, per area; `sigma` = ←σ, per solid angle; `merging` = η²
  /// if subpaths of the other side may merge at this vertex.
  RELUME_HD float sum(float p, float sigma, float merging = 0.0f) const {
    return zero_or(sqr(p), a + merging + zero_or(sqr(sigma), b));
  }
  /// The same sum for paths too long to be sampled from both sides: only the last cut is possible.
  RELUME_HD float last(float p) const { return zero_or(sqr(p), a); }
};

/// Weight of a strategy from the sums of both sides.
RELUME_HD inline float weight_from(float denominator_light, float denominator_camera) {
  return 1.0f / (1.0f + denominator_light + denominator_camera);
}

/// Evaluates the recursion along a subpath.
class SubpathWeights {
 public:
  /// State at the first vertex. `pdf`: of the direction, per solid angle (for `parallel` rays: of the position across
  /// them, per area). `inverse_hit_density`: inverse of the density with which the subpath chose the first vertex; 0 if
  /// the other side cannot hit it. `cosine`: at the first vertex; 1 for parallel rays. `direct_ratio`: density of the
  /// first vertex in connections over that in the subpath. `merging`: η² of vertex merging; 0: none. `connected`:
  /// square of the number of connections between surfaces per strategy.
  RELUME_HD static SubpathWeights start(float pdf, float inverse_hit_density, float cosine, float direct_ratio,
                                        bool parallel, float merging = 0.0f, float connected = 1.0f) {
    SubpathWeights w;
    w.merging_ = merging;
    w.connected_ = connected;
    w.pdf_ = pdf;
    w.connectable_ = sqr(direct_ratio);
    w.carried_ = sqr(cosine * inverse_hit_density);
    w.parallel_ = parallel;
    return w;
  }

  /// Moves to the next vertex, `distance_squared` away. `cosine`: of the ray to the geometric normal there. Both are 1
  /// for a vertex at infinity.
  RELUME_HD PartialWeights arrive(float cosine, float distance_squared) {
    const float density = pdf_ * cosine;
    const float inverse = density > 0.0f ? 1.0f / density : 0.0f;  // zero at the pole of a panoramic camera
    at_.a = zero_or(connectable_, sqr(parallel_ ? inverse : distance_squared * inverse));
    at_.b = zero_or(carried_, sqr(inverse));
    return at_;
  }

  RELUME_HD const PartialWeights& at() const { return at_; }
  /// η²
  RELUME_HD float merging() const { return merging_; }
  /// Sum over all strategies with a shorter subpath, if the last vertex is connected.
  RELUME_HD float sum(float p, float sigma) const { return at_.sum(p, sigma, merging_); }

  /// Leaves out the strategies with a shorter subpath than that to the current vertex: it is sampled in any case.
  RELUME_HD void restart() { at_ = {0, 0}; }

  /// Continues in a direction of density `pdf`; `reverse` is ←σ.
  RELUME_HD void leave(float cosine, float pdf, float reverse) {
    pdf_ = pdf;
    connectable_ = connected_;
    carried_ = sqr(cosine) * (at_.a + merging_ + zero_or(sqr(reverse), at_.b));
    parallel_ = false;
  }

  /// Continues by delta scattering; `ratio`: density of the other side over that of this one.
  RELUME_HD void leave_delta(float cosine, float ratio) {
    pdf_ = 1.0f;
    connectable_ = 0.0f;
    carried_ = zero_or(sqr(cosine * ratio), at_.b);
    parallel_ = false;
  }

 private:
  PartialWeights at_{0, 0};
  float pdf_ = 1;
  float connectable_ = 1;
  float carried_ = 0;
  float merging_ = 0;
  float connected_ = 1;
  bool parallel_ = false;
};

}  // namespace relume
