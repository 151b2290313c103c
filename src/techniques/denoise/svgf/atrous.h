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
  /// Number of values from a plane to the next.
  RELUME_HD_INLINE size_t plane_stride() const { return static_cast<size_t>(height) * stride(); }
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

/// h = h(dx) h(dy) of a tap, the weight of the B-spline. `squared`: dx² + dy², for |dx|, |dy| ≤ 2.
RELUME_HD_INLINE constexpr float spline(int squared) {
  constexpr float kWeights[3] = {0.375f, 0.25f, 0.0625f};
  switch (squared) {
    case 0: return kWeights[0] * kWeights[0];
    case 1: return kWeights[0] * kWeights[1];
    case 2: return kWeights[1] * kWeights[1];
    case 4: return kWeights[0] * kWeights[2];
    case 5: return kWeights[1] * kWeights[2];
    default: return kWeights[2] * kWeights[2];
  }
}

/// 1 / √(dx² + dy²) of a tap except the centre. The constants are rounded as a division by a square root is.
RELUME_HD_INLINE constexpr float inverse_distance(int squared) {
  switch (squared) {
    case 1: return 1.0f;
    case 2: return 1.0f / 1.41421356237f;
    case 4: return 0.5f;
    case 5: return 1.0f / 2.23606797750f;
    default: return 1.0f / 2.82842712475f;
  }
}

/// Where to load the inputs of a pixel, or of kLanes pixels in a row. Taps load each where they use it: registers would
/// not hold all of them.
struct PixelPlanes {
  const float* features;
  const float* light;
  size_t stride;  ///< values from a plane to the next, the same in both images

  /// `x` may reach into the margin.
  RELUME_HD_INLINE PixelPlanes(const AtrousImage& features_of, const AtrousImage& light_of, int x, uint32_t y)
      : features(features_of.at(0, 0, y) + x), light(light_of.at(0, 0, y) + x), stride(light_of.plane_stride()) {}

  template <typename F>
  RELUME_HD_INLINE F feature(AtrousPlane first, uint32_t component = 0) const {
    return load_lanes<F>(features + place_of(first, component) * stride);
  }
  template <typename F>
  RELUME_HD_INLINE F channel(uint32_t c) const {
    return load_lanes<F>(light + c * stride);
  }
};

/// Inputs of a pixel, or of kLanes pixels in a row.
template <typename F>
struct Pixels {
  F normal[3];
  F position[3];
  F channels[kAtrousChannels];

  RELUME_HD_INLINE explicit Pixels(const PixelPlanes& planes) {
    for (uint32_t c = 0; c < 3; ++c) {
      normal[c] = planes.feature<F>(AtrousPlane::normal_x, c);
      position[c] = planes.feature<F>(AtrousPlane::position_x, c);
    }
    for (uint32_t c = 0; c < kAtrousChannels; ++c) channels[c] = planes.channel<F>(c);
  }
  RELUME_HD_INLINE F brightness() const { return luminance(channels[0], channels[1], channels[2]); }

  /// Cosine between the normals.
  RELUME_HD_INLINE F cosine(const PixelPlanes& other) const {
    const F x = normal[0] * other.feature<F>(AtrousPlane::normal_x);
    const F y = normal[1] * other.feature<F>(AtrousPlane::normal_y);
    return x + y + normal[2] * other.feature<F>(AtrousPlane::normal_z);
  }
  /// Distance of another position from this plane, metres.
  RELUME_HD_INLINE F distance(const PixelPlanes& other) const {
    const F x = normal[0] * (other.feature<F>(AtrousPlane::position_x) - position[0]);
    const F y = normal[1] * (other.feature<F>(AtrousPlane::position_y) - position[1]);
    return absolute(x + y + normal[2] * (other.feature<F>(AtrousPlane::position_z) - position[2]));
  }
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
    const Pixels<F> pixels(PixelPlanes(features, light, static_cast<int>(x), y));
    const Centre<F> here{pixels, pixels.brightness(),
                         1.0f / (light_tolerance * square_root(steady_variance<F>(x, y)) + 1e-6f),
                         inverse_footprint * (1.0f / (plane_tolerance * static_cast<float>(step)))};
    TapSums<F> sums;
    sums.weight = F(spline(0));
    for (uint32_t c = 0; c < 3; ++c) sums.channels[c] = sums.weight * pixels.channels[c];
    sums.channels[kAtrousVariance] = sums.weight * sums.weight * pixels.channels[kAtrousVariance];
    for (int dy = -2; dy <= 2; ++dy) {
      const int row = static_cast<int>(y) + dy * static_cast<int>(step);
      if (row < 0 || row >= static_cast<int>(light.height)) continue;
      for (int dx = -2; dx <= 2; ++dx) {
        if (dx == 0 && dy == 0) continue;
        const PixelPlanes there(features, light, static_cast<int>(x) + dx * static_cast<int>(step),
                                static_cast<uint32_t>(row));
        add_tap(here, there, dx * dx + dy * dy, sums);
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

  /// Adds a tap. `squared`: of its distance from the centre, in steps.
  template <typename F>
  RELUME_HD_INLINE static void add_tap(const atrous_detail::Centre<F>& here, const atrous_detail::PixelPlanes& there,
                                       int squared, atrous_detail::TapSums<F>& sums) {
    using namespace atrous_detail;
    const F cosine = max(here.pixels.cosine(there), F(0.0f));
    const F distance = here.pixels.distance(there);
    const F r = there.channel<F>(0);
    const F g = there.channel<F>(1);
    const F b = there.channel<F>(2);
    const F contrast = absolute(luminance(r, g, b) - here.brightness);
    const F weight = spline(squared) * there.feature<F>(AtrousPlane::valid) * sharpened(cosine) *
                     falloff(distance * here.inverse_plane * inverse_distance(squared) + contrast * here.inverse_light);
    sums.channels[0] = sums.channels[0] + weight * r;
    sums.channels[1] = sums.channels[1] + weight * g;
    sums.channels[2] = sums.channels[2] + weight * b;
    sums.channels[kAtrousVariance] =
        sums.channels[kAtrousVariance] + weight * weight * there.channel<F>(kAtrousVariance);
    sums.weight = sums.weight + weight;
  }
};

}  // namespace relume
