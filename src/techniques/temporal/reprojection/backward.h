// Backward reprojection: the position of a pixel's surface in the previous frame, as weights of four pixels. Denoisers
// and reprojection with method "backward" read the previous frame through it.
#pragma once

#include "core/ray.h"
#include "framebuffer/pixel_moments.h"
#include "techniques/temporal/reprojection/reject_reason.h"

namespace relume {

/// Minimum sum of tap weights. A smaller sum comes from a corner pixel that matches by chance.
inline constexpr float kLeastTapWeight = 1e-3f;

/// Four pixels of the previous frame, with weights that sum to one. Pixels of weight 0 are not valid.
struct BackwardTaps {
  uint32_t pixels[4] = {0, 0, 0, 0};
  float weights[4] = {0, 0, 0, 0};
  bool valid = false;

  template <typename T>
  RELUME_HD T fetch(const View<const T>& values) const {
    T sum(0);
    for (int k = 0; k < 4; ++k) {
      if (weights[k] > 0.0f) sum += values[pixels[k]] * weights[k];
    }
    return sum;
  }

  /// Smallest value at the taps; 0 without any.
  RELUME_HD uint32_t least(const View<const uint32_t>& values) const {
    if (!valid) return 0;
    uint32_t result = 0xffffffffu;
    for (int k = 0; k < 4; ++k) {
      if (weights[k] > 0.0f) result = relume::min(result, values[pixels[k]]);
    }
    return result;
  }

  /// The taps with samples, by `counts`, normalised.
  RELUME_HD BackwardTaps known(const View<const uint32_t>& counts) const {
    BackwardTaps result = *this;
    bool all = true;
    for (int k = 0; k < 4; ++k) {
      if (!(weights[k] > 0.0f) || counts[pixels[k]] > 0) continue;
      result.weights[k] = 0.0f;
      all = false;
    }
    if (!all) result.normalise();
    return result;
  }

  /// Scales the weights to sum to one. Not valid if their sum is almost zero.
  RELUME_HD void normalise() {
    const float sum = weights[0] + weights[1] + weights[2] + weights[3];
    valid = valid && sum > kLeastTapWeight;
    const float scale = valid ? 1.0f / sum : 0.0f;
    for (float& w : weights) w *= scale;
  }

  /// Σ w²: variance of fetch() as a fraction of a single pixel's variance.
  RELUME_HD float variance_share() const {
    float sum = 0;
    for (const float w : weights) sum += sqr(w);
    return sum;
  }

  /// The pixel with the largest weight, the first of several. Requires `valid`.
  RELUME_HD uint32_t heaviest() const {
    int most = 0;
    for (int k = 1; k < 4; ++k) {
      if (weights[k] > weights[most]) most = k;
    }
    return pixels[most];
  }
};

/// Tolerances of a match with the previous frame: cosine between the normals, and distance of the old surface from the
/// new one's plane as a fraction of the depth.
inline constexpr float kBackwardNormalCosine = 0.9f;
inline constexpr float kBackwardPlaneDistance = 0.01f;

/// Surfaces of the pixels in this frame and the previous one: buffers of SurfacePass (primary_hits_pass.h) or of
/// FeaturesPass (features_pass.h).
struct BackwardReprojection {
  View<const Vec2> motion;     ///< pixels, from the previous frame to this one
  View<const Vec3> came_from;  ///< position of this frame's surface in the previous frame, metres
  View<const Vec3> normal;
  View<const float> depth;       ///< metres
  View<const uint32_t> surface;  ///< identifier of the surface; kNoSurface: the background
  View<const Vec3> previous_position;
  View<const Vec3> previous_normal;
  View<const uint32_t> previous_surface;
  uint32_t width = 0;
  uint32_t height = 0;

  /// Whether any of the four pixels around the previous position of pixel (x, y) lies in the image.
  RELUME_HD bool was_in_image(uint32_t x, uint32_t y) const {
    const Vec2& way = motion[y * width + x];
    const float x0 = std::floor(static_cast<float>(x) - way.x);
    const float y0 = std::floor(static_cast<float>(y) - way.y);
    return x0 >= -1.0f && y0 >= -1.0f && x0 < static_cast<float>(width) && y0 < static_cast<float>(height);
  }

  /// Bilinear taps around the previous position of pixel (x, y), without those on other surfaces.
  RELUME_HD BackwardTaps taps(uint32_t x, uint32_t y) const {
    BackwardTaps result;
    const uint32_t pixel = y * width + x;
    const float fx = static_cast<float>(x) - motion[pixel].x;
    const float fy = static_cast<float>(y) - motion[pixel].y;
    const float x0 = std::floor(fx);
    const float y0 = std::floor(fy);
    if (!was_in_image(x, y)) return result;
    const float wx = fx - x0;
    const float wy = fy - y0;
    if (wx == 0.0f && wy == 0.0f) return single_tap(pixel, static_cast<int>(x0), static_cast<int>(y0));
    for (int k = 0; k < 4; ++k) {
      const int px = static_cast<int>(x0) + (k & 1);
      const int py = static_cast<int>(y0) + (k >> 1);
      if (px < 0 || py < 0 || px >= static_cast<int>(width) || py >= static_cast<int>(height)) continue;
      const float weight = ((k & 1) ? wx : 1.0f - wx) * ((k >> 1) ? wy : 1.0f - wy);
      const uint32_t other = static_cast<uint32_t>(py) * width + static_cast<uint32_t>(px);
      if (weight == 0.0f || !same_surface(pixel, other)) continue;
      result.pixels[k] = other;
      result.weights[k] = weight;
    }
    result.valid = true;
    result.normalise();
    return result;
  }

  /// taps() with samples, by `counts`. Without any, the nearest of the eight surrounding pixels that fits and has
  /// samples: pixels on an edge may show one surface in one frame and the other in the next.
  RELUME_HD BackwardTaps taps_or_nearest(uint32_t x, uint32_t y, const View<const uint32_t>& counts) const {
    BackwardTaps result = taps(x, y).known(counts);
    if (result.valid) return result;
    result = {};
    const uint32_t pixel = y * width + x;
    const float fx = std::floor(static_cast<float>(x) - motion[pixel].x + 0.5f);
    const float fy = std::floor(static_cast<float>(y) - motion[pixel].y + 0.5f);
    if (!(fx >= 0.0f && fy >= 0.0f && fx < static_cast<float>(width) && fy < static_cast<float>(height))) return result;
    // By distance: edge neighbours before corners.
    constexpr int kOffsets[8][2] = {{-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
    for (const auto& offset : kOffsets) {
      const int px = static_cast<int>(fx) + offset[0];
      const int py = static_cast<int>(fy) + offset[1];
      if (px < 0 || py < 0 || px >= static_cast<int>(width) || py >= static_cast<int>(height)) continue;
      const uint32_t other = static_cast<uint32_t>(py) * width + static_cast<uint32_t>(px);
      if (counts[other] == 0 || !same_surface(pixel, other)) continue;
      result.pixels[0] = other;
      result.weights[0] = 1.0f;
      result.valid = true;
      return result;
    }
    return result;
  }

 private:
  /// taps() without motion, or with motion by whole pixels.
  RELUME_HD BackwardTaps single_tap(uint32_t pixel, int x, int y) const {
    BackwardTaps result;
    if (x < 0 || y < 0) return result;
    result.pixels[0] = static_cast<uint32_t>(y) * width + static_cast<uint32_t>(x);
    result.valid = same_surface(pixel, result.pixels[0]);
    result.weights[0] = result.valid ? 1.0f : 0.0f;
    return result;
  }

  RELUME_HD bool same_surface(uint32_t pixel, uint32_t other) const {
    if (surface[pixel] != previous_surface[other]) return false;
    if (surface[pixel] == kNoSurface) return true;
    if (glm::dot(normal[pixel], previous_normal[other]) < kBackwardNormalCosine) return false;
    const float distance = std::fabs(glm::dot(previous_position[other] - came_from[pixel], normal[pixel]));
    return distance <= kBackwardPlaneDistance * depth[pixel];
  }
};

/// Moments between pixels of the previous frame: means and variances are interpolated, and the count is the smallest of
/// the taps'.
struct InterpolatedHistory {
  MomentsView before;
  MutableMomentsView now;
  View<const Rgb> specular_before = {};  ///< part of the means that moves separately; may be empty
  View<const Rgb> specular = {};         ///< that part at this frame's pixels

  /// Stores the pixel's history, interpolated from `taps`. Returns its sample count.
  RELUME_HD uint32_t inherit(uint32_t pixel, const BackwardTaps& taps) const {
    PixelMoments moments;
    moments.samples = taps.least(before.samples);
    if (moments.samples > 0) moments.mean = mean(taps);
    moments.m2 = squares(taps, before.m2, moments.samples);
    if (!before.m2_rgb.empty()) moments.m2_rgb = squares(taps, before.m2_rgb, moments.samples);
    if (!specular.empty()) moments.mean += specular[pixel];
    now.store(pixel, moments);
    return moments.samples;
  }

 private:
  RELUME_HD Rgb mean(const BackwardTaps& taps) const {
    if (specular_before.empty()) return taps.fetch(before.mean);
    Rgb sum(0);
    for (int k = 0; k < 4; ++k) {
      const uint32_t tap = taps.pixels[k];
      if (taps.weights[k] > 0.0f) sum += (before.mean[tap] - specular_before[tap]) * taps.weights[k];
    }
    return sum;
  }

  /// Sum of squares of `count` samples that have the mean variance of the taps. `count`: the smallest of the taps'.
  RELUME_HD float squares(const BackwardTaps& taps, const View<const float>& sums, uint32_t count) const {
    float variance = 0;
    for (int k = 0; k < 4 && count > 1; ++k) {
      if (!(taps.weights[k] > 0.0f)) continue;
      const uint32_t tap = taps.pixels[k];
      variance += sums[tap] * (taps.weights[k] / static_cast<float>(before.samples[tap] - 1u));
    }
    return count > 1 ? variance * static_cast<float>(count - 1u) : variance;
  }
};

/// Backward method of reprojection. Other surface buffers may not permit interpolation, so they move from the heaviest
/// tap.
struct BackwardHistoryKernel {
  BackwardReprojection reprojection;
  InterpolatedHistory history;
  View<uint32_t> sources;  ///< heaviest tap, or kNoSource
  View<uint32_t> kept;
  View<uint32_t> reasons;  ///< RejectReason

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * reprojection.width + x;
    const BackwardTaps taps = reprojection.taps(x, y);
    const uint32_t count = history.inherit(pixel, taps);
    kept[pixel] = count > 0;
    reasons[pixel] = static_cast<uint32_t>(reason(taps, count, x, y));
    sources[pixel] = count > 0 ? taps.heaviest() : kNoSource;
  }

 private:
  RELUME_HD RejectReason reason(const BackwardTaps& taps, uint32_t count, uint32_t x, uint32_t y) const {
    if (count > 0) return RejectReason::none;
    if (taps.valid) return RejectReason::empty;
    return reprojection.was_in_image(x, y) ? RejectReason::other_surface : RejectReason::off_screen;
  }
};

}  // namespace relume
