// Light selection by random descent of a light tree ([Conty18], [Moreau19]). Each step chooses a child in proportion to
// a bound on the light that it could send to the point. Visibility is ignored.
#pragma once

#include "core/lanes.h"
#include "core/vec.h"
#include "sampling/choose.h"
#include "scene/surface_point.h"
#include "techniques/light_sampling/light_selection/infinite_lights.h"
#include "techniques/light_sampling/light_selection/light_selection.h"

namespace relume {

inline constexpr uint32_t kLightTreeWidth = 8;
inline constexpr uint32_t kLightTreeLeafSize = 2;

/// Bounds of a group of lights: a sphere, and a cone of normals of half angle o, around which light spreads by up to
/// angle e.
struct LightBounds {
  Vec3 center;
  float radius;
  Vec3 axis;
  float cos_o;
  float cos_e;
  float intensity;
  float two_sided;  ///< 1: also emits in the opposite directions
};

/// Eight children in SoA layout.
struct LightTreeNode {
  float center[3][kLightTreeWidth];
  float radius[kLightTreeWidth];
  float axis[3][kLightTreeWidth];
  float cos_o[kLightTreeWidth];
  float cos_e[kLightTreeWidth];
  float intensity[kLightTreeWidth];  ///< 0: no child
  float two_sided[kLightTreeWidth];
  uint32_t child[kLightTreeWidth];   ///< node, or first light of a leaf
  uint32_t lights[kLightTreeWidth];  ///< number of lights in a leaf; 0: an inner node
  uint32_t parent;                   ///< 8 · node + child in the parent; kNoParent for the root
};

namespace light_tree {

inline constexpr uint32_t kNoParent = 0xffffffffu;

/// cos and sin of max(0, a − b).
template <typename T>
RELUME_HD inline T cos_of_difference(T cos_a, T sin_a, T cos_b, T sin_b) {
  return select(cos_a > cos_b, T(1.0f), cos_a * cos_b + sin_a * sin_b);
}
template <typename T>
RELUME_HD inline T sin_of_difference(T cos_a, T sin_a, T cos_b, T sin_b) {
  return select(cos_a > cos_b, T(0.0f), sin_a * cos_b - cos_a * sin_b);
}
template <typename T>
RELUME_HD inline T sine(T cosine) {
  return square_root(max(T(1.0f) - cosine * cosine, T(0.0f)));
}

/// The receiving point.
struct Point {
  Vec3 position;
  Vec3 normal;       ///< of the shading frame
  float both_sides;  ///< 1: light from behind counts too
};

/// Bound on the light from a group ([Conty18], §5). The distance is at least the radius, so the bound is finite inside.
template <typename T>
RELUME_HD inline T importance(const Point& p, const T center[3], T radius, const T axis[3], T cos_o, T cos_e,
                              T intensity, T two_sided) {
  const T zero(0.0f);
  const T one(1.0f);
  const T d[3] = {center[0] - T(p.position.x), center[1] - T(p.position.y), center[2] - T(p.position.z)};
  const T d2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
  const T r2 = radius * radius;
  const T inverse = one / square_root(max(d2, T(1e-20f)));
  // Half angle that the group subtends; π from inside.
  const auto inside = d2 < r2;
  const T cos_b = select(inside, T(-1.0f), square_root(max(one - r2 / max(d2, T(1e-20f)), zero)));
  const T sin_b = sine(cos_b);
  const T cos_signed = (axis[0] * d[0] + axis[1] * d[1] + axis[2] * d[2]) * (zero - inverse);
  const T cos_w = max(min(select(two_sided > zero, absolute(cos_signed), cos_signed), one), T(-1.0f));
  const T sin_w = sine(cos_w);
  const T sin_o = sine(cos_o);
  const T cos_x = cos_of_difference(cos_w, sin_w, cos_o, sin_o);
  const T sin_x = sin_of_difference(cos_w, sin_w, cos_o, sin_o);
  const T cos_emitted = cos_of_difference(cos_x, sin_x, cos_b, sin_b);
  const T incident_signed = (d[0] * T(p.normal.x) + d[1] * T(p.normal.y) + d[2] * T(p.normal.z)) * inverse;
  const T incident = select(T(p.both_sides) > zero, absolute(incident_signed), incident_signed);
  const T cos_i = max(min(incident, one), T(-1.0f));
  const T cos_incident = max(cos_of_difference(cos_i, sine(cos_i), cos_b, sin_b), zero);
  const T value = intensity * max(cos_emitted, zero) * cos_incident / max(max(d2, r2), T(1e-12f));
  return select(cos_emitted < cos_e, zero, value);
}

RELUME_HD inline float importance(const Point& p, const LightBounds& b) {
  const float center[3] = {b.center.x, b.center.y, b.center.z};
  const float axis[3] = {b.axis.x, b.axis.y, b.axis.z};
  return importance<float>(p, center, b.radius, axis, b.cos_o, b.cos_e, b.intensity, b.two_sided);
}

/// Weights of a node's children, and their sum. Intensities replace bounds that are all zero or overflow.
RELUME_HD inline float child_weights(const Point& p, const LightTreeNode& n, float weights[kLightTreeWidth]) {
  using T = HostLanes;
  static_assert(kLightTreeWidth % kWidthOf<T> == 0);
  for (uint32_t i = 0; i < kLightTreeWidth; i += kWidthOf<T>) {
    const auto at = [i](const float* from) { return load_lanes<T>(from + i); };
    const T center[3] = {at(n.center[0]), at(n.center[1]), at(n.center[2])};
    const T axis[3] = {at(n.axis[0]), at(n.axis[1]), at(n.axis[2])};
    store_lanes(weights + i, importance<T>(p, center, at(n.radius), axis, at(n.cos_o), at(n.cos_e), at(n.intensity),
                                           at(n.two_sided)));
  }
  float sum = 0;
  for (uint32_t i = 0; i < kLightTreeWidth; ++i) sum += weights[i];
  if (sum > 0.0f && is_finite(sum)) return sum;
  sum = 0;
  for (uint32_t i = 0; i < kLightTreeWidth; ++i) sum += weights[i] = n.intensity[i];
  return sum;
}

}  // namespace light_tree

namespace light_tree {

/// A stack of child indices, in 24 bytes.
class Way {
 public:
  static constexpr uint32_t kMost = 64;

  RELUME_HD uint32_t count() const { return count_; }
  RELUME_HD void push(uint32_t child) {
    high_ = high_ << kBits | middle_ >> (64 - kBits);
    middle_ = middle_ << kBits | low_ >> (64 - kBits);
    low_ = low_ << kBits | child;
    ++count_;
  }
  RELUME_HD uint32_t pop() {
    const uint32_t child = static_cast<uint32_t>(low_) % kLightTreeWidth;
    low_ = low_ >> kBits | middle_ << (64 - kBits);
    middle_ = middle_ >> kBits | high_ << (64 - kBits);
    high_ >>= kBits;
    --count_;
    return child;
  }

 private:
  static constexpr uint32_t kBits = 3;
  static_assert(1u << kBits == kLightTreeWidth && kMost * kBits <= 3 * 64);

  uint64_t low_ = 0;
  uint64_t middle_ = 0;
  uint64_t high_ = 0;
  uint32_t count_ = 0;
};

}  // namespace light_tree

struct LightTree {
  static constexpr uint32_t kMostLevels = light_tree::Way::kMost;

  View<const LightTreeNode> nodes;
  View<const LightBounds> bounds;  ///< in leaf order
  View<const LightId> lights;      ///< in leaf order
  View<const uint32_t> place;      ///< by light: 8 · node + child of its leaf; kNoParent: no emission
  InfiniteLights infinite;

  RELUME_HD LightSelection sample(const SurfacePoint& sp, ReusableNumber n) const {
    if (infinite.takes(n)) return infinite.sample(n);
    if (nodes.empty()) return {};
    const light_tree::Point p = point_of(sp);
    float pmf = 1.0f - infinite.share;
    for (uint32_t node = 0;;) {
      const LightTreeNode& at = nodes[node];
      float weights[kLightTreeWidth];
      const float sum = light_tree::child_weights(p, at, weights);
      const uint32_t child = choose_by_weight(weights, kLightTreeWidth, sum, n);
      pmf *= weights[child] / sum;
      if (at.lights[child] == 0) {
        node = at.child[child];
        continue;
      }
      float leaf[kLightTreeLeafSize];
      const float leaf_sum = leaf_weights(p, at, child, leaf);
      const uint32_t k = choose_by_weight(leaf, at.lights[child], leaf_sum, n);
      return {lights[at.child[child] + k], pmf * (leaf[k] / leaf_sum), n.u};
    }
  }

  RELUME_HD float pmf(const SurfacePoint& sp, LightId light) const {
    if (light >= infinite.first) return infinite.pmf(light);
    if (place.empty() || place[light] == light_tree::kNoParent) return 0.0f;
    const light_tree::Point p = point_of(sp);
    // The same factors in the same order as in sample(), so that the bits agree.
    light_tree::Way way;
    uint32_t node = 0;
    for (uint32_t at = place[light]; at != light_tree::kNoParent && way.count() < kMostLevels;
         at = nodes[node].parent) {
      node = at / kLightTreeWidth;
      way.push(at % kLightTreeWidth);
    }
    float pmf = 1.0f - infinite.share;
    for (;;) {
      const LightTreeNode& n = nodes[node];
      const uint32_t child = way.pop();
      float weights[kLightTreeWidth];
      const float sum = light_tree::child_weights(p, n, weights);
      pmf *= weights[child] / sum;
      node = n.child[child];
      if (way.count() == 0) return pmf * share_in_leaf(p, n, child, light);
    }
  }

 private:
  RELUME_HD static light_tree::Point point_of(const SurfacePoint& sp) {
    light_tree::Point p{sp.position, sp.frame.n, 0.0f};
    for (int i = 0; i < sp.bsdf.lobe_count; ++i) {
      if (is_rough_transmission(sp.bsdf.lobes[i].kind)) p.both_sides = 1.0f;
    }
    return p;
  }

  /// Share of a light in the weights of its leaf.
  RELUME_HD float share_in_leaf(const light_tree::Point& p, const LightTreeNode& n, uint32_t child,
                                LightId light) const {
    float leaf[kLightTreeLeafSize];
    const float sum = leaf_weights(p, n, child, leaf);
    for (uint32_t k = 0; k < n.lights[child]; ++k) {
      if (lights[n.child[child] + k] == light) return leaf[k] / sum;
    }
    return 0.0f;
  }

  RELUME_HD float leaf_weights(const light_tree::Point& p, const LightTreeNode& n, uint32_t child,
                               float weights[kLightTreeLeafSize]) const {
    float sum = 0;
    for (uint32_t k = 0; k < n.lights[child]; ++k)
      sum += weights[k] = light_tree::importance(p, bounds[n.child[child] + k]);
    if (sum > 0.0f && is_finite(sum)) return sum;
    sum = 0;
    for (uint32_t k = 0; k < n.lights[child]; ++k) sum += weights[k] = bounds[n.child[child] + k].intensity;
    return sum;
  }
};

}  // namespace relume
