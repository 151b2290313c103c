// Spatiotemporal variance-guided filtering ([Schied17]), except the filter itself (atrous.h): accumulates light and its
// moments over frames. Their variance sets the reach of the filter.
#pragma once

#include "core/lane_views.h"
#include "frame/tile_rows.h"
#include "techniques/denoise/shared/light_history.h"
#include "techniques/denoise/svgf/atrous.h"

namespace relume {

/// Number of samples below which the variance of a history comes from neighbouring pixels ([Schied17] §4.2).
inline constexpr uint32_t kYoungHistory = 4;

/// Temporal accumulation of light and of the first two moments of its luminance.
struct SvgfAccumulateKernel {
  LightHistory history;
  View<const Vec2> moments_before;
  View<Vec2> moments;

  /// Host: kLanes pixels at once where these moved together.
  void operator()(const Tile& tile) const {
    const auto lanes = [this](uint32_t x, uint32_t y) {
      RowHistory row;
      if (!history.accumulate(x, y, row)) return false;
      Lanes mean[2];
      mean[0] = luminance(row.light.x, row.light.y, row.light.z);
      mean[1] = mean[0] * mean[0];
      row.mean(moments_before, mean);
      store_pairs(&moments[history.pixel(x, y)].x, mean[0], mean[1]);
      return true;
    };
    for_each_in_rows(tile, lanes, [this](uint32_t x, uint32_t y) { (*this)(x, y); });
  }

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const PixelHistory pixel = history.accumulate(x, y);
    const float brightness = luminance(pixel.sample.light);
    moments[history.pixel(x, y)] = pixel.mean(moments_before, Vec2(brightness, sqr(brightness)));
  }
};

/// Computes the variance of the accumulated light and lays out the planes of the filter. Unfiltered pixels, to which
/// the filter gives no weight, keep their light; their other planes are zero.
struct SvgfPrepareKernel {
  View<const Vec3> position;
  View<const Vec3> normal;
  View<const Rgb> albedo;
  View<const float> depth;
  View<const Rgb> light;
  View<const Vec2> moments;
  View<const uint32_t> count;
  AtrousImage features;
  AtrousImage planes;           ///< light and variance
  float cone_width = 0;         ///< width of a pixel at the camera, metres
  float cone_spread = 0;        ///< growth of that width per metre
  float correlated_frames = 1;  ///< as in FrameContext
  uint32_t width = 0;
  uint32_t height = 0;

  /// Host: kLanes pixels at once, except at the image's left and right edge.
  void operator()(const Tile& tile) const {
    const auto lanes = [this](uint32_t x, uint32_t y) {
      const bool has_surroundings = x >= kReach && x + kLanes + kReach <= width;
      if (!has_surroundings && has_young(y * width + x)) return false;
      prepare_lanes(x, y);
      return true;
    };
    for_each_in_rows(tile, lanes, [this](uint32_t x, uint32_t y) { (*this)(x, y); });
  }

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const float footprint = footprint_at<float>(pixel);
    Rgb shown = light[pixel];
    float variance = 0.0f;
    const bool filtered = is_filtered(albedo[pixel]);
    bool valid = filtered;
    if (valid && count[pixel] >= kYoungHistory) {
      variance = variance_of(moments[pixel], count[pixel]);
    } else if (valid) {
      const Surroundings<float> around = surroundings<float>(x, y);
      valid = around.count > 0.0f;
      if (count[pixel] == 0) shown = Rgb(around.light[0], around.light[1], around.light[2]);
      variance = young_variance(around, static_cast<float>(count[pixel]));
    }
    put(AtrousPlane::valid, x, y, valid ? 1.0f : 0.0f);
    put(AtrousPlane::inverse_footprint, x, y, filtered && footprint > 0.0f ? 1.0f / footprint : 0.0f);
    const Vec3 n = filtered ? normal[pixel] : Vec3(0);
    const Vec3 p = filtered ? position[pixel] : Vec3(0);
    for (uint32_t c = 0; c < 3; ++c) {
      const auto i = static_cast<int>(c);
      *features.at(place_of(AtrousPlane::normal_x, c), x, y) = n[i];
      *features.at(place_of(AtrousPlane::position_x, c), x, y) = p[i];
      *planes.at(c, x, y) = shown[i];
    }
    *planes.at(kAtrousVariance, x, y) = variance;
  }

 private:
  static constexpr int kReach = 3;  ///< radius of the estimate from neighbours: 7 × 7

  /// Means over the surrounding pixels with samples. T: float, or Lanes for kLanes pixels in a row.
  template <typename T>
  struct Surroundings {
    T light[3];  ///< mean light of the pixels on the plane of the center; of all if none is
    T variance;  ///< variance of a sample among the pixels on the plane; among all if fewer than two are
    T count;     ///< number of pixels on the plane
  };

  /// Host: whether any of kLanes pixels takes its variance from its surroundings.
  bool has_young(uint32_t first) const {
    bool any = false;
    for (uint32_t i = first; i < first + kLanes; ++i) any |= count[i] < kYoungHistory && is_filtered(albedo[i]);
    return any;
  }

  /// operator()(x, y) for kLanes pixels.
  void prepare_lanes(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const LaneMask filtered = is_filtered(vector_at<Lanes>(albedo, pixel));
    Triple<Lanes> shown = vector_at<Lanes>(light, pixel);
    if (any_of(filtered)) {
      prepare_filtered(x, y, filtered, shown);
    } else {
      for (uint32_t plane = 0; plane < kAtrousPlanes; ++plane) store_lanes(features.at(plane, x, y), Lanes(0.0f));
      store_lanes(planes.at(kAtrousVariance, x, y), Lanes(0.0f));
    }
    put(planes, 0, x, y, shown);
  }

  /// Computes all planes except those of `shown`, the light, in which it replaces that of pixels without samples.
  void prepare_filtered(uint32_t x, uint32_t y, const LaneMask& filtered, Triple<Lanes>& shown) const {
    const uint32_t pixel = y * width + x;
    const Lanes zero(0.0f);
    const Lanes footprint = footprint_at<Lanes>(pixel);
    const Lanes n = count_at<Lanes>(count, pixel);
    Lanes m[2];
    get_pair(moments, pixel, m);
    LaneMask valid = filtered;
    Lanes variance = max(m[1] - m[0] * m[0], zero) / (n - 1.0f) * min(n, Lanes(correlated_frames));
    const LaneMask young = n < Lanes(static_cast<float>(kYoungHistory));
    if (any_of(filtered & young)) {
      const Surroundings<Lanes> around = surroundings<Lanes>(x, y);
      valid = filtered & ((!young) | (around.count > zero));
      variance = select(young, young_variance(around, n), variance);
      shown = select(filtered & (n < Lanes(1.0f)), {around.light[0], around.light[1], around.light[2]}, shown);
    }
    const Triple<Lanes> none = triple_of<Lanes>(Vec3(0));
    store_lanes(features.at(place_of(AtrousPlane::valid), x, y), select(valid, Lanes(1.0f), zero));
    store_lanes(features.at(place_of(AtrousPlane::inverse_footprint), x, y),
                select(filtered & (footprint > zero), 1.0f / footprint, zero));
    put(features, place_of(AtrousPlane::normal_x), x, y, select(filtered, vector_at<Lanes>(normal, pixel), none));
    put(features, place_of(AtrousPlane::position_x), x, y, select(filtered, vector_at<Lanes>(position, pixel), none));
    store_lanes(planes.at(kAtrousVariance, x, y), select(filtered, variance, zero));
  }

  static void put(const AtrousImage& image, uint32_t first, uint32_t x, uint32_t y, const Triple<Lanes>& v) {
    store_lanes(image.at(first, x, y), v.x);
    store_lanes(image.at(first + 1, x, y), v.y);
    store_lanes(image.at(first + 2, x, y), v.z);
  }

  RELUME_HD_INLINE static bool both(bool a, bool b) { return a && b; }
  RELUME_HD_INLINE static LaneMask both(const LaneMask& a, const LaneMask& b) { return a & b; }

  template <typename T>
  RELUME_HD_INLINE T footprint_at(uint32_t pixel) const {
    return cone_width + cone_spread * load_lanes<T>(&depth[pixel]);
  }
  template <typename T>
  RELUME_HD_INLINE void add_moments(uint32_t pixel, const MaskOf<T>& mask, T (&sums)[2]) const {
    T m[2];
    get_pair(moments, pixel, m);
    for (int i = 0; i < 2; ++i) sums[i] = sums[i] + select(mask, m[i], T(0.0f));
  }

  RELUME_HD void put(AtrousPlane plane, uint32_t x, uint32_t y, float value) const {
    *features.at(place_of(plane), x, y) = value;
  }

  /// Variance of the mean of n samples with moments `m`.
  RELUME_HD float variance_of(const Vec2& m, uint32_t n) const {
    const float variance = relume::max(m.y - sqr(m.x), 0.0f) / static_cast<float>(n - 1);
    return variance * relume::min(static_cast<float>(n), correlated_frames);
  }
  /// The same for `n` below kYoungHistory.
  template <typename T>
  RELUME_HD_INLINE static T young_variance(const Surroundings<T>& around, const T& n) {
    return around.variance * T(static_cast<float>(kYoungHistory)) / max(n, T(1.0f));
  }

  template <typename T>
  RELUME_HD_INLINE Surroundings<T> surroundings(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const Triple<T> n = vector_at<T>(normal, pixel);
    const Triple<T> p = vector_at<T>(position, pixel);
    const T reach = footprint_at<T>(pixel) * T(static_cast<float>(kReach));
    const Triple<T> zero = triple_of<T>(Vec3(0));
    Triple<T> on_plane = zero;
    Triple<T> anywhere = zero;
    T moments_on_plane[2] = {T(0.0f), T(0.0f)};
    T moments_anywhere[2] = {T(0.0f), T(0.0f)};
    T count_on_plane(0.0f);
    T count_anywhere(0.0f);
    for (int dy = -kReach; dy <= kReach; ++dy) {
      for (int dx = -kReach; dx <= kReach; ++dx) {
        const int qx = static_cast<int>(x) + dx;
        const int qy = static_cast<int>(y) + dy;
        if (qx < 0 || qy < 0 || qx >= static_cast<int>(width) || qy >= static_cast<int>(height)) continue;
        const uint32_t other = static_cast<uint32_t>(qy) * width + static_cast<uint32_t>(qx);
        const Triple<T> value = vector_at<T>(light, other);
        const MaskOf<T> known = both(count_at<T>(count, other) > T(0.0f), is_filtered(vector_at<T>(albedo, other)));
        const T distance = absolute(dot(n, vector_at<T>(position, other) - p));
        const MaskOf<T> aligned = dot(n, vector_at<T>(normal, other)) > T(0.9f);
        const MaskOf<T> same = both(known, both(!(distance > reach), aligned));
        anywhere = anywhere + select(known, value, zero);
        count_anywhere = count_anywhere + select(known, T(1.0f), T(0.0f));
        on_plane = on_plane + select(same, value, zero);
        count_on_plane = count_on_plane + select(same, T(1.0f), T(0.0f));
        add_moments<T>(other, same, moments_on_plane);
        add_moments<T>(other, known, moments_anywhere);
      }
    }
    const MaskOf<T> any = count_on_plane > T(0.0f);
    const T divisor = max(select(any, count_on_plane, count_anywhere), T(1.0f));
    const Triple<T> sum = select(any, on_plane, anywhere);
    const MaskOf<T> several = count_on_plane > T(1.0f);
    const T measured = max(select(several, count_on_plane, count_anywhere), T(1.0f));
    const T mean = select(several, moments_on_plane[0], moments_anywhere[0]) / measured;
    const T square = select(several, moments_on_plane[1], moments_anywhere[1]) / measured;
    return {{sum.x / divisor, sum.y / divisor, sum.z / divisor}, max(square - mean * mean, T(0.0f)), count_on_plane};
  }
};

/// Light of pixel (x, y) from the planes of a filtered image.
RELUME_HD inline Rgb light_at(const AtrousImage& image, uint32_t x, uint32_t y) {
  return {*image.at(0, x, y), *image.at(1, x, y), *image.at(2, x, y)};
}
/// The same for kLanes pixels from (x, y) on.
RELUME_HD_INLINE Triple<Lanes> lanes_of_light(const AtrousImage& image, uint32_t x, uint32_t y) {
  return {load_lanes(image.at(0, x, y)), load_lanes(image.at(1, x, y)), load_lanes(image.at(2, x, y))};
}

/// The image from filtered light.
struct SvgfPresentKernel {
  SurfaceLight samples;
  AtrousImage filtered;
  View<Rgb> shown;
  uint32_t width = 0;

  /// Host: kLanes pixels at once.
  void operator()(const Tile& tile) const {
    const auto lanes = [this](uint32_t x, uint32_t y) {
      const uint32_t pixel = y * width + x;
      set_vector(shown, pixel, samples.image(pixel, lanes_of_light(filtered, x, y)));
      return true;
    };
    for_each_in_rows(tile, lanes, [this](uint32_t x, uint32_t y) { (*this)(x, y); });
  }

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    shown[pixel] = samples.image(pixel, light_at(filtered, x, y));
  }
};

/// The image from filtered diffuse and specular light.
struct SvgfPresentPartsKernel {
  SplitLight samples;
  AtrousImage diffuse;
  AtrousImage specular;  ///< may be empty if no pixel reflects
  View<Rgb> shown;
  View<Rgb> shown_specular;
  uint32_t width = 0;

  /// Host: kLanes pixels at once.
  void operator()(const Tile& tile) const {
    const auto lanes = [this](uint32_t x, uint32_t y) {
      const uint32_t pixel = y * width + x;
      Triple<Lanes> reflected = triple_of<Lanes>(Vec3(0));
      if (any_of(samples.reflecting(pixel))) reflected = samples.specular_part(pixel, lanes_of_light(specular, x, y));
      set_vector(shown_specular, pixel, reflected);
      set_vector(shown, pixel, samples.image(pixel, lanes_of_light(diffuse, x, y), reflected));
      return true;
    };
    for_each_in_rows(tile, lanes, [this](uint32_t x, uint32_t y) { (*this)(x, y); });
  }

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    Rgb reflected(0);
    if (samples.reflects(pixel)) reflected = samples.specular_part(pixel, light_at(specular, x, y));
    shown_specular[pixel] = reflected;
    shown[pixel] = samples.image(pixel, light_at(diffuse, x, y), reflected);
  }
};

}  // namespace relume
