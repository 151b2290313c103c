// Backward look-ups of kLanes pixels at once, on the host.
#pragma once

#include "techniques/temporal/reprojection/backward.h"
#include "techniques/temporal/reprojection/row_origin.h"

namespace relume {

/// BackwardTaps of kLanes pixels that were side by side in the previous frame too.
struct RowTaps {
  uint32_t pixels[4];  ///< of the first lane; the others follow
  Lanes weights[4];
  bool used[4];  ///< whether any lane's weight is positive

  /// BackwardTaps::fetch() of a buffer of vectors.
  RELUME_HD_INLINE Triple<Lanes> fetch(const View<const Vec3>& values) const {
    const Triple<Lanes> zero = triple_of<Lanes>(Vec3(0));
    Triple<Lanes> sum = zero;
    for (int k = 0; k < 4; ++k) {
      if (used[k]) sum = sum + select(weights[k] > Lanes(0.0f), vector_at<Lanes>(values, pixels[k]) * weights[k], zero);
    }
    return sum;
  }
  /// The same of a buffer of pairs.
  RELUME_HD_INLINE void fetch(const View<const Vec2>& values, Lanes (&sum)[2]) const {
    sum[0] = sum[1] = Lanes(0.0f);
    for (int k = 0; k < 4; ++k) {
      if (!used[k]) continue;
      Lanes pair[2];
      get_pair(values, pixels[k], pair);
      for (int i = 0; i < 2; ++i) sum[i] = sum[i] + select(weights[k] > Lanes(0.0f), pair[i] * weights[k], Lanes(0.0f));
    }
  }
  /// BackwardTaps::least(), by lane; 0xffffffff in lanes without taps, such as the background.
  RELUME_HD_INLINE void least(const View<const uint32_t>& values, uint32_t (&result)[kLanes]) const {
    for (uint32_t i = 0; i < kLanes; ++i) {
      result[i] = 0xffffffffu;
      for (int k = 0; k < 4; ++k) {
        const uint32_t value = weights[k][i] > 0.0f ? values[pixels[k] + i] : 0xffffffffu;
        result[i] = relume::min(result[i], value);
      }
    }
  }
};

namespace row_detail {

/// BackwardReprojection::same_surface() for kLanes pixels from `pixel` and `other` on.
RELUME_HD_INLINE LaneMask same_surfaces(const BackwardReprojection& r, uint32_t pixel, uint32_t other) {
  const Triple<Lanes> normal = vector_at<Lanes>(r.normal, pixel);
  const Triple<Lanes> offset = vector_at<Lanes>(r.previous_position, other) - vector_at<Lanes>(r.came_from, pixel);
  const LaneMask turned = dot(normal, vector_at<Lanes>(r.previous_normal, other)) < Lanes(kBackwardNormalCosine);
  const LaneMask near = absolute(dot(offset, normal)) <= kBackwardPlaneDistance * load_lanes(&r.depth[pixel]);
  const LaneMask same = mask_of([&](uint32_t i) { return r.surface[pixel + i] == r.previous_surface[other + i]; });
  const LaneMask background = mask_of([&](uint32_t i) { return r.surface[pixel + i] == kNoSurface; });
  return same & (background | ((!turned) & near));
}

/// BackwardTaps::normalise() for the lanes of `which`. Returns the lanes that are valid.
RELUME_HD_INLINE LaneMask normalise(RowTaps& taps, const LaneMask& which) {
  const Lanes sum = taps.weights[0] + taps.weights[1] + taps.weights[2] + taps.weights[3];
  const LaneMask valid = sum > Lanes(kLeastTapWeight);
  const Lanes scale = select(valid, 1.0f / sum, Lanes(0.0f));
  for (Lanes& weight : taps.weights) weight = select(which, weight * scale, weight);
  return valid | !which;
}

}  // namespace row_detail

/// taps_or_nearest() for pixels (x … x + kLanes − 1, y). Returns false if the caller must look them up one by one: they
/// were not side by side in the previous frame, some were outside the image, or one has no samples there. The
/// background needs no samples; its weights are 0.
RELUME_HD_INLINE bool find_taps(const BackwardReprojection& r, uint32_t x, uint32_t y,
                                const View<const uint32_t>& counts, RowTaps& taps) {
  RowOrigin origin;
  if (!find_row(r.motion, r.width, x, y, origin)) return false;
  if (origin.x < 0 || origin.x + static_cast<int>(kLanes) >= static_cast<int>(r.width)) return false;
  if (origin.y < 0 || origin.y + 1 >= static_cast<int>(r.height)) return false;
  const uint32_t pixel = y * r.width + x;
  const Lanes zero(0.0f);
  LaneMask unknown = zero < zero;  // a tap of the lane has no samples
  for (uint32_t k = 0; k < 4; ++k) {
    const Lanes& wx = origin.fraction_x;
    const Lanes& wy = origin.fraction_y;
    const Lanes weight = ((k & 1u) ? wx : 1.0f - wx) * ((k >> 1) ? wy : 1.0f - wy);
    const uint32_t other =
        (static_cast<uint32_t>(origin.y) + (k >> 1)) * r.width + static_cast<uint32_t>(origin.x) + (k & 1u);
    taps.pixels[k] = other;
    taps.used[k] = any_of(weight > zero);
    taps.weights[k] = taps.used[k] ? select(row_detail::same_surfaces(r, pixel, other), weight, zero) : zero;
  }
  const LaneMask all = zero <= zero;
  LaneMask valid = row_detail::normalise(taps, all);
  for (uint32_t k = 0; k < 4; ++k) {
    const LaneMask empty = mask_of([&](uint32_t i) { return counts[taps.pixels[k] + i] == 0; });
    const LaneMask removed = empty & (taps.weights[k] > zero);
    unknown = unknown | removed;
    taps.weights[k] = select(removed, zero, taps.weights[k]);
  }
  if (any_of(unknown)) valid = valid & row_detail::normalise(taps, unknown);
  const LaneMask background = mask_of([&](uint32_t i) { return r.surface[pixel + i] == kNoSurface; });
  for (uint32_t k = 0; k < 4; ++k) {
    taps.weights[k] = select(background, zero, taps.weights[k]);
    taps.used[k] = any_of(taps.weights[k] > zero);
  }
  return !any_of(!(valid | background));
}

}  // namespace relume
