// Last step of a denoiser: averages images over time. The average is antialiased, because the samples of a pixel at an
// edge fall on either side of it.
#pragma once

#include <type_traits>

#include "frame/tile_rows.h"
#include "techniques/gbuffer/features/features.h"
#include "techniques/temporal/reprojection/row_origin.h"

namespace relume {

/// Specular part of images, which has a separate motion.
struct SpecularImages {
  View<const Rgb> shown;
  View<const Rgb> before;
  View<const Vec2> motion;
  View<Rgb> image;                    ///< empty: part of the image of all light
  View<const uint32_t> samples = {};  ///< as in ImageHistoryKernel
};

/// Light with one motion: an image minus the parts that have another motion.
struct MovingLight {
  View<const Rgb> image;
  View<const Rgb> without[2] = {};  ///< parts to subtract; empty: none

  template <typename T>
  RELUME_HD_INLINE Triple<T> at(uint32_t pixel) const {
    Triple<T> light = vector_at<T>(image, pixel);
    for (const View<const Rgb>& part : without) {
      if (!part.empty()) light = light - vector_at<T>(part, pixel);
    }
    return light;
  }
};

/// Where to interpolate the previous image for one pixel, or for kLanes pixels that were side by side there too.
template <typename T>
struct ImageOrigin {
  bool known = false;   ///< false: outside the image, or hidden in the previous frame
  int x = 0;            ///< column of weights_x[1], for the first pixel
  int y = 0;            ///< row of weights_y[1]
  T weights_x[4] = {};  ///< weights of columns x − 1 … x + 2
  T weights_y[4] = {};  ///< weights of rows y − 1 … y + 2
};

/// Averages this frame's filtered image with earlier ones. While nothing changes, filtered images improve and get
/// growing weights. Unfiltered pixels, such as lamps and sky, and the part of a pixel that these cover, are averaged
/// with equal weights: unequal ones would add noise at edges. With upscaling, the average of filtered images begins
/// with the first frame after which every pixel has a sample.
///
/// Where something moves, the previous image is looked up along the motion and clamped to the range of this frame's
/// surrounding pixels. Surfaces that have just come into view have no previous image. This frame's image, smoothed over
/// 3 × 3 pixels, replaces it: small dark or bright surfaces would otherwise become dots.
struct ImageHistoryKernel {
  View<const Rgb> shown;  ///< filtered image of this frame
  View<const Rgb> before;
  View<const Vec2> motion;
  View<const Rgb> albedo;
  View<const Rgb> emission;           ///< shown emission
  View<const uint32_t> edge_rays;     ///< number of camera rays in the mean `emission`; 0 or empty: the sample's alone
  View<const Rgb> unfiltered_before;  ///< `unfiltered` of the previous frame
  View<Rgb> unfiltered;               ///< unfiltered part of `image`: a mean since the last change
  View<float> filtered_share;         ///< fraction of frames since then that filtered the pixel; updated
  View<Rgb> image;
  SpecularImages specular;
  /// Number of samples in each pixel's light; 1: a surface that has just come into view. Empty: no surface counts as
  /// new.
  View<const uint32_t> samples;
  float newest = 1;       ///< weight of this frame where something moves; 1: discards earlier images
  uint32_t frames = 1;    ///< frames since the last change, including this one
  uint32_t averaged = 1;  ///< number of latest frames whose filtered images are averaged
  bool still = false;     ///< nothing has changed
  uint32_t width = 0;
  uint32_t height = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const { update<float>(x, y); }

  /// Host: kLanes pixels at once where these moved together.
  void operator()(const Tile& tile) const {
    for_each_in_rows(
        tile, [this](uint32_t x, uint32_t y) { return update<Lanes>(x, y); },
        [this](uint32_t x, uint32_t y) { update<float>(x, y); });
  }

 private:
  template <typename T>
  static constexpr bool kIsSingle = std::is_same_v<T, float>;

  RELUME_HD bool apart() const { return !specular.image.empty(); }

  /// Updates a pixel, or kLanes pixels from (x, y) on. Returns false, and changes nothing, if these must be updated one
  /// by one.
  template <typename T>
  RELUME_HD_INLINE bool update(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const Triple<T> now = vector_at<T>(shown, pixel);
    const MaskOf<T> filtered = is_filtered(vector_at<T>(albedo, pixel));
    const Triple<T> seen = select(filtered, vector_at<T>(emission, pixel), now);
    if (still && newest < 1.0f) {
      average<T>(pixel, now, seen, filtered);
      if (apart()) average_specular<T>(pixel);
      return true;
    }
    if (newest >= 1.0f) {
      set_vector(image, pixel, now);
      if (apart()) set_vector(specular.image, pixel, vector_at<T>(specular.shown, pixel));
    } else if (!blend<T>(x, y)) {
      return false;
    }
    set_vector(unfiltered, pixel, seen);
    set_number(filtered_share, pixel, select(filtered, T(1.0f), T(0.0f)));
    return true;
  }

  /// image = unfiltered part + share · filtered part, the latter with linearly growing weights.
  template <typename T>
  RELUME_HD_INLINE void average(uint32_t pixel, const Triple<T>& now, const Triple<T>& seen,
                                const MaskOf<T>& filtered) const {
    const T n(static_cast<float>(static_cast<int>(frames)));
    const T zero(0.0f);
    const Triple<T> seen_before = vector_at<T>(unfiltered_before, pixel);
    const T share_before = load_lanes<T>(&filtered_share[pixel]);
    const Triple<T> mean = seen_before + (seen - seen_before) / n;
    const T share = share_before + (select(filtered, T(1.0f), zero) - share_before) / n;
    Triple<T> light =
        select<T>(share_before > zero, (vector_at<T>(before, pixel) - seen_before) / share_before, {zero, zero, zero});
    const T images = share * T(static_cast<float>(static_cast<int>(averaged)));
    const T weight = relume::min(T(2.0f) / (images + T(1.0f)), T(1.0f));
    light = select<T>(filtered, light + (now - seen - light) * weight, light);
    set_vector(unfiltered, pixel, mean);
    set_number(filtered_share, pixel, share);
    set_vector(image, pixel, not_negative(mean + light * share));
  }

  template <typename T>
  RELUME_HD_INLINE void average_specular(uint32_t pixel) const {
    const Triple<T> history = vector_at<T>(specular.before, pixel);
    const T share(relume::min(2.0f / static_cast<float>(averaged + 1), 1.0f));
    set_vector(specular.image, pixel, history + (vector_at<T>(specular.shown, pixel) - history) * share);
  }

  /// Blends this frame with the moved history, each part by its motion. Returns false if the pixels did not move
  /// together.
  template <typename T>
  RELUME_HD_INLINE bool blend(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const bool edge = has_edge<T>(pixel);
    ImageOrigin<T> origin;
    ImageOrigin<T> specular_origin;
    if (edge && !kIsSingle<T>) return false;
    if (!find(motion, samples, x, y, origin)) return false;
    if (apart() && !find(specular.motion, specular.samples, x, y, specular_origin)) return false;
    MovingLight now{shown};
    MovingLight past{before};
    // The emission at edges is a mean of many rays, which a moved image would only blur.
    if (edge) {
      now.without[1] = emission;
      past.without[1] = unfiltered_before;
    }
    if (!apart()) {
      const Triple<T> light = blended(x, y, origin, now, past);
      set_vector(image, pixel, edge ? not_negative(vector_at<T>(emission, pixel) + light) : light);
      return true;
    }
    now.without[0] = specular.shown;
    past.without[0] = specular.before;
    const Triple<T> reflected = blended<T>(x, y, specular_origin, {specular.shown}, {specular.before});
    Triple<T> light = reflected + blended(x, y, origin, now, past);
    if (edge) light = light + vector_at<T>(emission, pixel);
    set_vector(specular.image, pixel, reflected);
    set_vector(image, pixel, not_negative(light));
    return true;
  }

  /// Whether any of the pixels shows measured emission at an edge.
  template <typename T>
  RELUME_HD_INLINE bool has_edge(uint32_t pixel) const {
    bool any = false;
    for (uint32_t k = 0; !edge_rays.empty() && k < (kIsSingle<T> ? 1 : kLanes); ++k) any |= edge_rays[pixel + k] > 0;
    return any;
  }

  template <typename T>
  RELUME_HD_INLINE static Triple<T> not_negative(const Triple<T>& light) {
    return max_of(light, triple_of<T>(Vec3(0)));
  }

  /// Weights of four pixels in a row for a position at fraction t between the second and the third ([Keys81], a =
  /// −1/2). Linear interpolation would blur more with every frame.
  template <typename T>
  RELUME_HD_INLINE static void cubic_weights(const T& t, T (&w)[4]) {
    w[0] = ((-0.5f * t + 1.0f) * t - 0.5f) * t;
    w[1] = (1.5f * t - 2.5f) * t * t + 1.0f;
    w[2] = ((-1.5f * t + 2.0f) * t + 0.5f) * t;
    w[3] = (0.5f * t - 0.5f) * t * t;
  }

  /// Whether the surfaces of a pixel and of most of the 3 × 3 pixels around it have just come into view. A single new
  /// pixel, such as a distant window, keeps the history of the image, which contains its surface.
  RELUME_HD bool is_new(const View<const uint32_t>& counts, uint32_t x, uint32_t y) const {
    if (counts.empty() || counts[y * width + x] != 1) return false;
    uint32_t fresh = 0;
    for (int j = -1; j <= 1; ++j) {
      const uint32_t row = inside(static_cast<int>(y) + j, height) * width;
      for (int i = -1; i <= 1; ++i) fresh += counts[row + inside(static_cast<int>(x) + i, width)] == 1 ? 1u : 0u;
    }
    return 2 * fresh > 9;
  }

  /// Finds a pixel in the previous frame. Always returns true.
  RELUME_HD bool find(const View<const Vec2>& by, const View<const uint32_t>& counts, uint32_t x, uint32_t y,
                      ImageOrigin<float>& origin) const {
    if (is_new(counts, x, y)) return true;
    const Vec2& way = by[y * width + x];
    const float fx = static_cast<float>(x) - way.x;
    const float fy = static_cast<float>(y) - way.y;
    if (!(fx >= 0.0f && fy >= 0.0f && fx <= static_cast<float>(width - 1) && fy <= static_cast<float>(height - 1)))
      return true;
    origin.known = true;
    origin.x = static_cast<int>(fx);
    origin.y = static_cast<int>(fy);
    cubic_weights(fx - static_cast<float>(origin.x), origin.weights_x);
    cubic_weights(fy - static_cast<float>(origin.y), origin.weights_y);
    return true;
  }

  /// Finds kLanes pixels in the previous frame. Returns false if they were not side by side there, if one is new, or if
  /// columns around them lie outside the image in either frame.
  RELUME_HD_INLINE bool find(const View<const Vec2>& by, const View<const uint32_t>& counts, uint32_t x, uint32_t y,
                             ImageOrigin<Lanes>& origin) const {
    RowOrigin row;
    if (x == 0 || x + kLanes >= width || !find_row(by, width, x, y, row)) return false;
    if (row.x < 1 || row.x + static_cast<int>(kLanes) + 1 >= static_cast<int>(width)) return false;
    if (row.y < 0 || row.y + 1 >= static_cast<int>(height)) return false;
    for (uint32_t k = 0; k < kLanes; ++k) {
      if (is_new(counts, x + k, y)) return false;
    }
    origin.known = true;
    origin.x = row.x;
    origin.y = row.y;
    cubic_weights(row.fraction_x, origin.weights_x);
    cubic_weights(row.fraction_y, origin.weights_y);
    return true;
  }

  /// Blend of this frame's light and the clamped history.
  template <typename T>
  RELUME_HD_INLINE Triple<T> blended(uint32_t x, uint32_t y, const ImageOrigin<T>& origin, const MovingLight& now,
                                     const MovingLight& past) const {
    const Triple<T> history = moved(x, y, origin, now, past);
    return history + (now.at<T>(y * width + x) - history) * T(newest);
  }

  /// Previous light at the origin, clamped to the range of this frame's light in the 3 × 3 pixels around (x, y). If the
  /// origin is unknown, this frame's smoothed light at (x, y).
  template <typename T>
  RELUME_HD_INLINE Triple<T> moved(uint32_t x, uint32_t y, const ImageOrigin<T>& origin, const MovingLight& now,
                                   const MovingLight& past) const {
    if (!origin.known) return smoothed<T>(x, y, now);
    Triple<T> low = now.at<T>(y * width + x);
    Triple<T> history = triple_of<T>(Vec3(0));
    for (int j = 0; j < 4; ++j) {
      const uint32_t row = inside(origin.y + j - 1, height) * width;
      for (int i = 0; i < 4; ++i) {
        const T weight = origin.weights_x[i] * origin.weights_y[j];
        history = history + past.at<T>(row + inside(origin.x + i - 1, width)) * weight;
      }
    }
    Triple<T> high = low;
    for (int j = -1; j <= 1; ++j) {
      const uint32_t row = inside(static_cast<int>(y) + j, height) * width;
      for (int i = -1; i <= 1; ++i) {
        const Triple<T> neighbour = now.at<T>(row + inside(static_cast<int>(x) + i, width));
        low = min_of(low, neighbour);
        high = max_of(high, neighbour);
      }
    }
    return min_of(max_of(history, low), high);
  }

  /// This frame's light, smoothed by a triangle over 3 × 3 pixels. Their samples lie at different places in a pixel.
  /// Unfiltered pixels, such as lamps and sky, keep their light and do not count for others.
  template <typename T>
  RELUME_HD_INLINE Triple<T> smoothed(uint32_t x, uint32_t y, const MovingLight& now) const {
    Triple<T> sum = triple_of<T>(Vec3(0));
    T weights(0.0f);
    for (int j = -1; j <= 1; ++j) {
      const uint32_t row = inside(static_cast<int>(y) + j, height) * width;
      for (int i = -1; i <= 1; ++i) {
        const uint32_t other = row + inside(static_cast<int>(x) + i, width);
        const T triangle((i == 0 ? 0.5f : 0.25f) * (j == 0 ? 0.5f : 0.25f));
        const T weight = select(is_filtered(vector_at<T>(albedo, other)), triangle, T(0.0f));
        sum = sum + now.at<T>(other) * weight;
        weights = weights + weight;
      }
    }
    const uint32_t pixel = y * width + x;
    return select<T>(is_filtered(vector_at<T>(albedo, pixel)), sum / weights, now.at<T>(pixel));
  }

  RELUME_HD static uint32_t inside(int i, uint32_t size) {
    return i < 0 ? 0u : (i < static_cast<int>(size) ? static_cast<uint32_t>(i) : size - 1);
  }
};

}  // namespace relume
