// Multiple importance sampling weights of bidirectional path tracing, computed along the subpaths.
//
// A path x0 … xk can be sampled with its first s vertices from the light and the other t = k + 1 − s from the camera.
// With the power heuristic (β = 2, [Veach97] eq. 9.13) strategy s has the weight 1 / Σ_j (p_j / p_s)². Seen from the
// end of one subpath with vertices x0 … xi, the terms of all strategies in which that subpath is shorter are
//
//   (←p_i)² · (A_i + (←σ_i)² B_i)
//
//   A_i = v_i / (→p_i)²                                       the strategy that cuts between x(i−1) and xi
//   B_i = (←g_(i−1) / →p_i)² · (A_(i−1) + (←σ_(i−1))² B_(i−1))   those that cut before
//
// where →p is the density per area with which the subpath found a vertex and ←p that of the subpath from the other
// side; ←σ_i is the other side's density per solid angle of going on from xi to x(i−1); ←g_(i−1) = cos / d² turns it
// into one per area at x(i−1); v is 1 where both ends of the cut can be connected to (no delta scattering), else 0.
// Only ←p_i and ←σ_i depend on what the subpath is connected to, so A and B are all that a vertex has to carry. The
// same idea, in other groupings, is behind the quantities of [Antwerpen11] and [Georgiev12].
//
// At a delta scattering both directions' densities are the same Dirac pulse, up to the probabilities of choosing the
// lobe and the Jacobian of refraction: A_i vanishes on both sides of the vertex and B goes on with that factor instead
// of ←σ.
//
// Lights at infinity (and orthographic cameras) have directions instead of positions: their x0 is measured per solid
// angle, and x1 is found with a density per area facing that direction, without a distance.
#pragma once

#include "core/vec.h"

namespace relume {

/// factor · value, also if the value is beyond the range of a float, as in scenes of enormous extent.
RELUME_HD inline float zero_or(float factor, float value) { return factor > 0.0f ? factor * value : 0.0f; }

/// Part of a weight that is known at one end of a subpath.
struct PartialWeights {
  float a;
  float b;

  /// Sum over all strategies with a shorter subpath. `p` = ←p, per area; `sigma` = ←σ, per solid angle.
  RELUME_HD float sum(float p, float sigma) const { return zero_or(sqr(p), a + zero_or(sqr(sigma), b)); }
  /// The same for paths too long to be sampled from both sides: only the last cut is possible.
  RELUME_HD float last(float p) const { return zero_or(sqr(p), a); }
};

/// The weight of a strategy whose denominator sum up to these.
RELUME_HD inline float weight_from(float denominator_light, float denominator_camera) {
  return 1.0f / (1.0f + denominator_light + denominator_camera);
}

/// Carries the recursion along a subpath.
class SubpathWeights {
 public:
  /// At the first vertex. `pdf`: of the direction, per solid angle (for `parallel` rays: of the position across them,
  /// per area). `inverse_hit_density`: one over the density with which the subpath chose the first vertex; 0 if the
  /// other side cannot hit it. `cosine`: at the first vertex; 1 for parallel rays. `direct_ratio`: density with which a
  /// connection chooses the first vertex over that with which the subpath chose it.
  RELUME_HD static SubpathWeights start(float pdf, float inverse_hit_density, float cosine, float direct_ratio,
                                        bool parallel) {
    SubpathWeights w;
    w.pdf_ = pdf;
    w.connectable_ = sqr(direct_ratio);
    w.carried_ = sqr(cosine * inverse_hit_density);
    w.parallel_ = parallel;
    return w;
  }

  /// At the next vertex, `distance_squared` away, where the ray makes `cosine` with the geometric normal. A vertex at
  /// infinity has 1 for both.
  RELUME_HD PartialWeights arrive(float cosine, float distance_squared) {
    const float density = pdf_ * cosine;
    const float inverse = density > 0.0f ? 1.0f / density : 0.0f;  // the pole of a panoramic camera: no density at all
    at_.a = zero_or(connectable_, sqr(parallel_ ? inverse : distance_squared * inverse));
    at_.b = zero_or(carried_, sqr(inverse));
    return at_;
  }

  RELUME_HD const PartialWeights& at() const { return at_; }

  /// Goes on in a direction of density `pdf`; `reverse` is ←σ.
  RELUME_HD void leave(float cosine, float pdf, float reverse) {
    pdf_ = pdf;
    connectable_ = 1.0f;
    carried_ = sqr(cosine) * (at_.a + zero_or(sqr(reverse), at_.b));
    parallel_ = false;
  }

  /// Goes on by delta scattering; `ratio` of the other side's density to this one's.
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
  bool parallel_ = false;
};

}  // namespace relume
