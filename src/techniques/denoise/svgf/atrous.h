// One level of the edge-avoiding à-trous filter of [Schied17] §4.4: a 5 × 5 B-spline with spaced taps, weighted by the
// similarity of normals, planes and light. Written once for a float and for lanes of floats.
#pragma once

#include "core/lanes.h"
#include "core/vec.h"
#include "core/view.h"
#include "frame/launch.h"

namespace relume {

/// Planes of features that a level reads.
enum class AtrousPlane : uint32_t {
  valid,  ///< 1: takes part in the filter, 0: does not
  normal_x,
  normal_y,
  normal_z,
  position_x,
  position_y,
  position_z,
  inverse_footprint,  ///< 1 / width of a pixel on the surface, 1/metres; 0: the filter copies the pixel
  count,
};
inline constexpr uint32_t kAtrousPlanes = static_cast<uint32_t>(AtrousPlane::count);
/// Index of a plane. For vectors, `first` is the plane of the first component.
RELUME_HD constexpr uint32_t place_of(AtrousPlane first, uint32_t component = 0) {
  return static_cast<uint32_t>(first) + component;
}
/// Planes that a level filters: red, green, blue, and the variance of the luminance.
inline constexpr uint32_t kAtrousChannels = 4;
inline constexpr uint32_t kAtrousVariance = 3;

/// Planes one after another. Nothing is valid in the margin on either side, where strips of pixels may be read and
/// written.
struct AtrousImage {
  static constexpr uint32_t kMargin = 40;  ///< reach of the last level, 2 · 2⁴, and a strip

  View<float> values;
  uint32_t width = 0;
  uint32_t height = 0;

  RELUME_HD_INLINE uint32_t stride() const { return width + 2 * kMargin; }
  RELUME_HD_INLINE float* at(uint32_t plane, uint32_t x, uint32_t y) const {
    return values.data + (static_cast<size_t>(plane) * height + y) * stride() + kMargin + x;
  }
  static constexpr size_t size(uint32_t planes, uint32_t w, uint32_t h) {
    return static_cast<size_t>(planes) * h * (w + 2 * kMargin);
  }
};

namespace atrous_detail {

/// (1 + x/8)⁻⁸ for x ≥ 0: differs from e⁻ˣ by at most 0.03, without a table.
template <typename F>
RELUME_HD_INLINE F falloff(const F& x) {
  const F root = 1.0f + x * 0.125f;
  const F square = root * root;
  const F fourth = square * square;
  return 1.0f / (fourth * fourth);
}

/// For code that runs with masks of lanes, too.
RELUME_HD_INLINE bool any_of(bool condition) { return condition; }

/// x¹²⁸.
template <typename F>
RELUME_HD_INLINE F sharpened(F x) {
  for (int i = 0; i < 7; ++i) x = x * x;
  return x;
}

/// Inputs of a pixel, or of kLanes pixels in a row.
template <typename F>
struct Pixels {
  F normal[3];
  F position[3];
  F channels[kAtrousChannels];

  RELUME_HD_INLINE Pixels(const AtrousImage& features, const AtrousImage& light, uint32_t x, uint32_t y) {
    for (uint32_t c = 0; c < 3; ++c) {
      normal[c] = load_lanes<F>(features.at(place_of(AtrousPlane::normal_x, c), x, y));
      position[c] = load_lanes<F>(features.at(place_of(AtrousPlane::position_x, c), x, y));
    }
    for (uint32_t c = 0; c < kAtrousChannels; ++c) channels[c] = load_lanes<F>(light.at(c, x, y));
  }
  RELUME_HD_INLINE F brightness() const { return luminance(channels[0], channels[1], channels[2]); }
};

/// Centre with which the taps of a pixel are compared.
template <typename F>
struct Centre {
  Pixels<F> pixels;
  F brightness;
  F inverse_light;  ///< 1 / tolerance of brightness
  F inverse_plane;  ///< 1 / tolerated distance of a tap one step away from the plane, metres
};

/// Sums over the taps of a pixel.
template <typename F>
struct TapSums {
  F channels[kAtrousChannels];
  F weight;
};

}  // namespace atrous_detail

struct AtrousKernel {
  AtrousImage features;  ///< kAtrousPlanes planes
  AtrousImage light;     ///< kAtrousChannels planes
  AtrousImage filtered;  ///< kAtrousChannels planes
  uint32_t step = 1;     ///< pixels between taps
  float plane_tolerance = 1;
  float light_tolerance = 2;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const { filter<float>(x, y); }

  /// Host: kLanes pixels at once, which may reach into the margin.
  void operator()(const Tile& tile) const {
    for (uint32_t y = tile.y0; y < tile.y1; ++y) {
      for (uint32_t x = tile.x0; x < tile.x1; x += kLanes) filter<Lanes>(x, y);
    }
  }

 private:
  RELUME_HD static constexpr float spline(int offset) {
    return offset == 0 ? 0.375f : (offset == 1 || offset == -1 ? 0.25f : 0.0625f);
  }

  /// Variance smoothed over 3 × 3 pixels, for a steady tolerance of light ([Schied17 eq. 5]).
  template <typename F>
  RELUME_HD_INLINE F steady_variance(uint32_t x, uint32_t y) const {
    using namespace atrous_detail;
    F sum(0.0f);
    F total(0.0f);
    for (int dy = -1; dy <= 1; ++dy) {
      const int row = static_cast<int>(y) + dy;
      if (row < 0 || row >= static_cast<int>(light.height)) continue;
      for (int dx = -1; dx <= 1; ++dx) {
        const auto column = static_cast<uint32_t>(static_cast<int>(x) + dx);  // −1 lies in the margin
        const F weight = load_lanes<F>(at(features, place_of(AtrousPlane::valid), column, static_cast<uint32_t>(row))) *
                         ((dx == 0 ? 0.5f : 0.25f) * (dy == 0 ? 0.5f : 0.25f));
        sum = sum + weight * load_lanes<F>(at(light, kAtrousVariance, column, static_cast<uint32_t>(row)));
        total = total + weight;
      }
    }
    return sum / max(total, F(1e-6f));
  }

  /// `column` may be negative, wrapped to unsigned.
  RELUME_HD_INLINE static const float* at(const AtrousImage& image, uint32_t plane, uint32_t column, uint32_t row) {
    return image.at(plane, 0, row) + static_cast<int32_t>(column);
  }

  template <typename F>
  RELUME_HD_INLINE void filter(uint32_t x, uint32_t y) const {
    using namespace atrous_detail;
    const F inverse_footprint = load_lanes<F>(features.at(place_of(AtrousPlane::inverse_footprint), x, y));
    const MaskOf<F> changes = inverse_footprint > F(0.0f);
    if (!any_of(changes)) return copy<F>(x, y);
    const Pixels<F> pixels(features, light, x, y);
    const Centre<F> here{pixels, pixels.brightness(),
                         1.0f / (light_tolerance * square_root(steady_variance<F>(x, y)) + 1e-6f),
                         inverse_footprint * (1.0f / (plane_tolerance * static_cast<float>(step)))};
    TapSums<F> sums;
    sums.weight = F(spline(0) * spline(0));
    for (uint32_t c = 0; c < 3; ++c) sums.channels[c] = sums.weight * pixels.channels[c];
    sums.channels[kAtrousVariance] = sums.weight * sums.weight * pixels.channels[kAtrousVariance];
    for (int dy = -2; dy <= 2; ++dy) {
      const int row = static_cast<int>(y) + dy * static_cast<int>(step);
      if (row < 0 || row >= static_cast<int>(light.height)) continue;
      for (int dx = -2; dx <= 2; ++dx) {
        if (dx == 0 && dy == 0) continue;
        tap<F>(here, static_cast<int>(x) + dx * static_cast<int>(step), row, dx, dy, sums);
      }
    }
    const F inverse = 1.0f / sums.weight;
    sums.channels[kAtrousVariance] = sums.channels[kAtrousVariance] * inverse;
    for (uint32_t c = 0; c < kAtrousChannels; ++c)
      store_lanes(filtered.at(c, x, y), select(changes, sums.channels[c] * inverse, pixels.channels[c]));
  }

  template <typename F>
  RELUME_HD_INLINE void copy(uint32_t x, uint32_t y) const {
    for (uint32_t c = 0; c < kAtrousChannels; ++c) store_lanes(filtered.at(c, x, y), load_lanes<F>(light.at(c, x, y)));
  }

  template <typename F>
  RELUME_HD_INLINE void tap(const atrous_detail::Centre<F>& here, int column, int row, int dx, int dy,
                            atrous_detail::TapSums<F>& sums) const {
    using namespace atrous_detail;
    const auto x = static_cast<uint32_t>(column);
    const auto y = static_cast<uint32_t>(row);
    F cosine(0.0f);
    F distance(0.0f);
    for (uint32_t c = 0; c < 3; ++c) {
      const F normal = here.pixels.normal[c];
      cosine = cosine + normal * load_lanes<F>(at(features, place_of(AtrousPlane::normal_x, c), x, y));
      const F position = load_lanes<F>(at(features, place_of(AtrousPlane::position_x, c), x, y));
      distance = distance + normal * (position - here.pixels.position[c]);
    }
    F channels[kAtrousChannels];
    for (uint32_t c = 0; c < kAtrousChannels; ++c) channels[c] = load_lanes<F>(at(light, c, x, y));
    const F contrast = absolute(luminance(channels[0], channels[1], channels[2]) - here.brightness);
    const float apart = std::sqrt(static_cast<float>(dx * dx + dy * dy));
    const F weight = (spline(dx) * spline(dy)) * load_lanes<F>(at(features, place_of(AtrousPlane::valid), x, y)) *
                     sharpened(max(cosine, F(0.0f))) *
                     falloff(absolute(distance) * here.inverse_plane * (1.0f / apart) + contrast * here.inverse_light);
    for (uint32_t c = 0; c < 3; ++c) sums.channels[c] = sums.channels[c] + weight * channels[c];
    sums.channels[kAtrousVariance] = sums.channels[kAtrousVariance] + weight * weight * channels[kAtrousVariance];
    sums.weight = sums.weight + weight;
  }
};

}  // namespace relume
