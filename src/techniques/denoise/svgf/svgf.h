// Spatiotemporal variance-guided filtering ([Schied17]), except the filter itself (atrous.h): accumulates light and its
// moments over frames. Their variance sets the reach of the filter.
#pragma once

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

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const PixelHistory pixel = history.accumulate(x, y);
    const float brightness = luminance(pixel.sample.light);
    moments[history.pixel(x, y)] = pixel.mean(moments_before, Vec2(brightness, sqr(brightness)));
  }
};

/// Computes the variance of the accumulated light and lays out the planes of the filter.
struct SvgfPrepareKernel {
  View<const Vec3> position;
  View<const Vec3> normal;
  View<const Rgb> albedo;
  View<const float> depth;
  View<const Rgb> light;
  View<const Vec2> moments;
  View<const uint32_t> count;
  AtrousImage features;
  AtrousImage planes;     ///< light and variance
  float cone_width = 0;   ///< width of a pixel at the camera, metres
  float cone_spread = 0;  ///< growth of that width per metre
  uint32_t width = 0;
  uint32_t height = 0;

  /// Host: kLanes pixels at once where none has a young history.
  void operator()(const Tile& tile) const {
    for (uint32_t y = tile.y0; y < tile.y1; ++y) {
      uint32_t x = tile.x0;
      for (; x + kLanes <= tile.x1; x += kLanes) {
        if (has_young(y * width + x)) {
          for (uint32_t k = 0; k < kLanes; ++k) (*this)(x + k, y);
        } else {
          prepare_lanes(x, y);
        }
      }
      for (; x < tile.x1; ++x) (*this)(x, y);
    }
  }

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const float footprint = footprint_at(pixel);
    Rgb shown = light[pixel];
    float variance = 0.0f;
    bool valid = is_filtered(albedo[pixel]);
    if (valid && count[pixel] >= kYoungHistory) {
      variance = variance_of(moments[pixel], count[pixel]);
    } else if (valid) {
      const Surroundings around = surroundings(x, y);
      valid = around.count > 0.0f;
      if (count[pixel] == 0) shown = valid ? around.light : around.any_light;
      variance =
          around.variance * static_cast<float>(kYoungHistory) / relume::max(1.0f, static_cast<float>(count[pixel]));
    }
    put(AtrousPlane::valid, x, y, valid ? 1.0f : 0.0f);
    put(AtrousPlane::inverse_footprint, x, y, footprint > 0.0f ? 1.0f / footprint : 0.0f);
    for (uint32_t c = 0; c < 3; ++c) {
      *features.at(place_of(AtrousPlane::normal_x, c), x, y) = normal[pixel][static_cast<int>(c)];
      *features.at(place_of(AtrousPlane::position_x, c), x, y) = position[pixel][static_cast<int>(c)];
      *planes.at(c, x, y) = shown[static_cast<int>(c)];
    }
    *planes.at(kAtrousVariance, x, y) = variance;
  }

 private:
  static constexpr int kReach = 3;  ///< radius of the estimate from neighbours: 7 × 7

  /// Means over the surrounding pixels on the same plane.
  struct Surroundings {
    Rgb light{0};
    float variance = 0;  ///< variance of a single sample
    float count = 0;
    Rgb any_light{0};  ///< mean over all filtered pixels with samples, if none lies on the pixel's plane
  };

  /// Whether any of kLanes pixels takes its variance from its surroundings.
  bool has_young(uint32_t first) const {
    bool any = false;
    for (uint32_t i = first; i < first + kLanes; ++i) any |= count[i] < kYoungHistory && is_filtered(albedo[i]);
    return any;
  }

  /// operator()(x, y) for kLanes pixels, none of which has_young().
  void prepare_lanes(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    Lanes color[3];
    load_vectors(&albedo[pixel].x, color);
    const LaneMask black = max(color[0], max(color[1], color[2])) < Lanes(kLeastAlbedo);
    const Lanes footprint = cone_width + cone_spread * load_lanes(&depth[pixel]);
    store_lanes(features.at(place_of(AtrousPlane::valid), x, y), select(black, Lanes(0.0f), Lanes(1.0f)));
    store_lanes(features.at(place_of(AtrousPlane::inverse_footprint), x, y),
                select(footprint > Lanes(0.0f), 1.0f / footprint, Lanes(0.0f)));
    Lanes n[3];
    Lanes p[3];
    Lanes shown[3];
    load_vectors(&normal[pixel].x, n);
    load_vectors(&position[pixel].x, p);
    load_vectors(&light[pixel].x, shown);
    for (uint32_t c = 0; c < 3; ++c) {
      store_lanes(features.at(place_of(AtrousPlane::normal_x, c), x, y), n[c]);
      store_lanes(features.at(place_of(AtrousPlane::position_x, c), x, y), p[c]);
      store_lanes(planes.at(c, x, y), shown[c]);
    }
    Lanes m[2];
    load_pairs(&moments[pixel].x, m);
    Lanes others;
    for (uint32_t k = 0; k < kLanes; ++k) others.v[k] = static_cast<float>(count[pixel + k] - 1);
    const Lanes variance = max(m[1] - m[0] * m[0], Lanes(0.0f)) / others;
    store_lanes(planes.at(kAtrousVariance, x, y), select(black, Lanes(0.0f), variance));
  }

  RELUME_HD float footprint_at(uint32_t pixel) const { return cone_width + cone_spread * depth[pixel]; }
  RELUME_HD void put(AtrousPlane plane, uint32_t x, uint32_t y, float value) const {
    *features.at(place_of(plane), x, y) = value;
  }

  /// Variance of the mean of n samples with moments `m`.
  RELUME_HD static float variance_of(const Vec2& m, uint32_t n) {
    return relume::max(m.y - sqr(m.x), 0.0f) / static_cast<float>(n - 1);
  }

  RELUME_HD bool same_plane(uint32_t pixel, uint32_t other) const {
    const float distance = std::fabs(glm::dot(normal[pixel], position[other] - position[pixel]));
    return distance <= footprint_at(pixel) * kReach && glm::dot(normal[pixel], normal[other]) >= 0.9f;
  }

  RELUME_HD Surroundings surroundings(uint32_t x, uint32_t y) const {
    Surroundings s;
    Vec2 sum(0);
    float any = 0;
    for (int dy = -kReach; dy <= kReach; ++dy) {
      for (int dx = -kReach; dx <= kReach; ++dx) {
        const int qx = static_cast<int>(x) + dx;
        const int qy = static_cast<int>(y) + dy;
        if (qx < 0 || qy < 0 || qx >= static_cast<int>(width) || qy >= static_cast<int>(height)) continue;
        const uint32_t other = static_cast<uint32_t>(qy) * width + static_cast<uint32_t>(qx);
        if (count[other] == 0 || !is_filtered(albedo[other])) continue;
        s.any_light += light[other];
        any += 1.0f;
        if (!same_plane(y * width + x, other)) continue;
        sum += moments[other];
        s.light += light[other];
        s.count += 1.0f;
      }
    }
    if (any > 0.0f) s.any_light /= any;
    if (s.count == 0.0f) return s;
    s.light /= s.count;
    s.variance = relume::max(sum.y / s.count - sqr(sum.x / s.count), 0.0f);
    return s;
  }
};

/// The image from filtered light.
struct SvgfPresentKernel {
  SurfaceLight samples;
  AtrousImage filtered;
  View<Rgb> shown;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    shown[pixel] = samples.image(pixel, light_at(filtered, x, y));
  }

  RELUME_HD static Rgb light_at(const AtrousImage& image, uint32_t x, uint32_t y) {
    return {*image.at(0, x, y), *image.at(1, x, y), *image.at(2, x, y)};
  }
};

/// The image from filtered diffuse and specular light.
struct SvgfPresentPartsKernel {
  SplitLight samples;
  AtrousImage diffuse;
  AtrousImage specular;
  View<Rgb> shown;
  View<Rgb> shown_specular;
  uint32_t width = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    Rgb reflected(0);
    if (samples.reflects(pixel)) {
      reflected = samples.specular_part(pixel, SvgfPresentKernel::light_at(specular, x, y));
    }
    shown_specular[pixel] = reflected;
    shown[pixel] = samples.image(pixel, SvgfPresentKernel::light_at(diffuse, x, y), reflected);
  }
};

}  // namespace relume
