// Last step of a denoiser: averages images over time. Samples of a pixel fall on either side of an edge, so the average
// smooths it.
#pragma once

#include "core/lanes.h"
#include "core/vec.h"
#include "core/view.h"
#include "frame/launch.h"
#include "techniques/gbuffer/features/features.h"

namespace relume {

/// Least number of samples with a known variance of their mean.
inline constexpr uint32_t kKnownSamples = 4;

/// Specular part of images, which has a separate motion.
struct SpecularImages {
  View<const Rgb> shown;
  View<const Rgb> before;
  View<const Vec2> motion;
  View<Rgb> image;  ///< empty: not kept apart
};

/// Averages this frame's filtered image with earlier ones. While nothing changes, filtered images improve and get
/// growing weights. Unfiltered pixels, such as lamps and sky, and the part of a pixel that these cover, are averaged
/// with equal weights: unequal ones would add noise at edges. With upscaling, the average of filtered images begins
/// with the first frame after which every pixel has a sample. Where something moves, the previous image is looked up
/// along the motion and clamped to the range of this frame's surrounding pixels.
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
  float newest = 1;       ///< weight of this frame where something moves; 1: discards earlier images
  uint32_t frames = 1;    ///< frames since the last change, including this one
  uint32_t averaged = 1;  ///< number of latest frames whose filtered images are averaged
  bool still = false;     ///< nothing has changed
  uint32_t width = 0;
  uint32_t height = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const Rgb now = shown[pixel];
    const bool filtered = is_filtered(albedo[pixel]);
    const Rgb seen = filtered ? emission[pixel] : now;
    if (still && newest < 1.0f) {
      average(pixel, now, seen, filtered);
      if (apart()) average_specular(pixel);
      return;
    }
    unfiltered[pixel] = seen;
    filtered_share[pixel] = filtered ? 1.0f : 0.0f;
    if (newest >= 1.0f) {
      image[pixel] = now;
      if (apart()) specular.image[pixel] = specular.shown[pixel];
    } else if (apart()) {
      blend_parts(x, y);
    } else if (!edge_rays.empty() && edge_rays[pixel] > 0) {
      // The emission is a mean of many rays, which a moved image would only blur.
      const auto scattered = [this](uint32_t i) { return shown[i] - emission[i]; };
      const auto scattered_before = [this](uint32_t i) { return before[i] - unfiltered_before[i]; };
      image[pixel] = glm::max(emission[pixel] + blended(x, y, motion[pixel], scattered, scattered_before), Rgb(0));
    } else {
      image[pixel] = blended(
          x, y, motion[pixel], [this](uint32_t i) { return shown[i]; }, [this](uint32_t i) { return before[i]; });
    }
  }

 private:
  RELUME_HD bool apart() const { return !specular.image.empty(); }

  RELUME_HD void average_specular(uint32_t pixel) const {
    const Rgb history = specular.before[pixel];
    const float share = relume::min(2.0f / static_cast<float>(averaged + 1), 1.0f);
    specular.image[pixel] = history + (specular.shown[pixel] - history) * share;
  }

  /// Looks each part up along its motion.
  RELUME_HD void blend_parts(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * width + x;
    const Rgb reflected = blended(
        x, y, specular.motion[pixel], [this](uint32_t i) { return specular.shown[i]; },
        [this](uint32_t i) { return specular.before[i]; });
    specular.image[pixel] = reflected;
    const bool edge = !edge_rays.empty() && edge_rays[pixel] > 0;
    const auto rest = [&](uint32_t i) { return shown[i] - specular.shown[i] - (edge ? emission[i] : Rgb(0)); };
    const auto rest_before = [&](uint32_t i) {
      return before[i] - specular.before[i] - (edge ? unfiltered_before[i] : Rgb(0));
    };
    const Rgb blended_rest = blended(x, y, motion[pixel], rest, rest_before);
    image[pixel] = glm::max(reflected + blended_rest + (edge ? emission[pixel] : Rgb(0)), Rgb(0));
  }

  /// image = unfiltered part + share · filtered part, the latter with linearly growing weights.
  RELUME_HD void average(uint32_t pixel, const Rgb& now, const Rgb& seen, bool filtered) const {
    const auto n = static_cast<float>(static_cast<int>(frames));
    const Rgb seen_before = unfiltered_before[pixel];
    const float share_before = filtered_share[pixel];
    const Rgb mean = seen_before + (seen - seen_before) / n;
    const float share = share_before + ((filtered ? 1.0f : 0.0f) - share_before) / n;
    Rgb light(0);
    if (share_before > 0.0f) light = (before[pixel] - seen_before) / share_before;
    const float images = share * static_cast<float>(static_cast<int>(averaged));
    if (filtered) light += (now - seen - light) * relume::min(2.0f / (images + 1.0f), 1.0f);
    unfiltered[pixel] = mean;
    filtered_share[pixel] = share;
    image[pixel] = glm::max(mean + light * share, Rgb(0));
  }

  /// Weights of four pixels in a row for a position at fraction t between the second and the third ([Keys81], a =
  /// −1/2). Linear interpolation would blur more with every frame.
  RELUME_HD static void cubic_weights(float t, float (&w)[4]) {
    w[0] = ((-0.5f * t + 1.0f) * t - 0.5f) * t;
    w[1] = (1.5f * t - 2.5f) * t * t + 1.0f;
    w[2] = ((-1.5f * t + 2.0f) * t + 0.5f) * t;
    w[3] = (0.5f * t - 0.5f) * t * t;
  }

  /// Blend of this frame's value and the clamped history at the surface's previous position.
  template <typename Now, typename Before>
  RELUME_HD Rgb blended(uint32_t x, uint32_t y, const Vec2& way, const Now& now, const Before& past) const {
    const Rgb history = moved(x, y, way, now, past);
    return history + (now(y * width + x) - history) * newest;
  }

  template <typename Now, typename Before>
  RELUME_HD Rgb moved(uint32_t x, uint32_t y, const Vec2& way, const Now& now, const Before& past) const {
    const uint32_t pixel = y * width + x;
    const float fx = static_cast<float>(x) - way.x;
    const float fy = static_cast<float>(y) - way.y;
    if (!(fx >= 0.0f && fy >= 0.0f && fx <= static_cast<float>(width - 1) && fy <= static_cast<float>(height - 1)))
      return now(pixel);
    const int x0 = static_cast<int>(fx);
    const int y0 = static_cast<int>(fy);
    float wx[4];
    float wy[4];
    cubic_weights(fx - static_cast<float>(x0), wx);
    cubic_weights(fy - static_cast<float>(y0), wy);
    Rgb history(0);
    for (int j = 0; j < 4; ++j) {
      const uint32_t row = inside(y0 + j - 1, height) * width;
      for (int i = 0; i < 4; ++i) history += past(row + inside(x0 + i - 1, width)) * (wx[i] * wy[j]);
    }
    Rgb low = now(pixel);
    Rgb high = low;
    for (int j = -1; j <= 1; ++j) {
      const uint32_t row = inside(static_cast<int>(y) + j, height) * width;
      for (int i = -1; i <= 1; ++i) {
        const Rgb neighbour = now(row + inside(static_cast<int>(x) + i, width));
        low = glm::min(low, neighbour);
        high = glm::max(high, neighbour);
      }
    }
    return glm::clamp(history, low, high);
  }

  RELUME_HD static uint32_t inside(int i, uint32_t size) {
    return i < 0 ? 0u : (i < static_cast<int>(size) ? static_cast<uint32_t>(i) : size - 1);
  }
};

/// Blends the image to the mean of all samples once the mean's error is below the filter's bias. The share is the part
/// of their squared difference, around the pixel, that the noise of the mean does not explain.
struct ConvergeKernel {
  View<const Rgb> image;
  View<const Rgb> mean;
  View<const float> m2;  ///< sum of squared distances of the samples' luminance from its mean
  View<const uint32_t> samples;
  View<Rgb> converged;
  bool stratified = false;  ///< as in FrameContext
  bool still = false;       ///< nothing has changed; otherwise the mean is not trusted
  uint32_t width = 0;
  uint32_t height = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    Difference sum;
    for (uint32_t v = y > kReach ? y - kReach : 0; still && v <= y + kReach && v < height; ++v) {
      Difference row;
      for (uint32_t u = x > kReach ? x - kReach : 0; u <= x + kReach && u < width; ++u) row += at(v * width + u);
      sum += row;
    }
    finish(y * width + x, sum);
  }

  /// Host: reads each pixel once and sums rows of the tile, which vectorises.
  void operator()(const Tile& tile) const {
    SumsOfRow sums[kTileSize] = {};
    for (uint32_t j = 0; still && j < kEdge; ++j) {
      const uint32_t y = tile.y0 + j - kReach;  // wraps beyond the height above the image
      if (y >= height) continue;
      const SumsOfRow row = row_around(tile.x0, y);
      for (uint32_t t = j > 2 * kReach ? j - 2 * kReach : 0; t <= j && t < kTileSize; ++t)
        sums[t].add(row.squared, row.variance, row.most_squared, row.most_variance);
    }
    for (uint32_t y = tile.y0; y < tile.y1; ++y) {
      const SumsOfRow& row = sums[y - tile.y0];
      for (uint32_t x = tile.x0; x < tile.x1; ++x) {
        const uint32_t i = x - tile.x0;
        finish(y * width + x, {row.squared[i], row.variance[i], row.most_squared[i], row.most_variance[i]});
      }
    }
  }

 private:
  static constexpr uint32_t kReach = 2;
  static constexpr uint32_t kEdge = kTileSize + 2 * kReach;
  static constexpr uint32_t kPaddedEdge = (kEdge + kLanes - 1) / kLanes * kLanes;
  static constexpr float kStratifiedSamples = 16;  ///< sample count above which stratification is assumed

  /// Sums over pixels. The largest difference is kept apart: it may be a firefly.
  struct Difference {
    float squared = 0;
    float variance = 0;
    float most_squared = 0;
    float most_variance = 0;  ///< assumed reduction of that pixel's variance by stratification

    RELUME_HD void operator+=(const Difference& other) {
      squared += other.squared;
      variance += other.variance;
      if (other.most_squared <= most_squared) return;
      most_squared = other.most_squared;
      most_variance = other.most_variance;
    }
  };

  /// A Difference for each pixel in a row of a tile.
  struct SumsOfRow {
    float squared[kTileSize];
    float variance[kTileSize];
    float most_squared[kTileSize];
    float most_variance[kTileSize];

    RELUME_HD_INLINE void add(const float* squares, const float* variances, const float* most_squares,
                              const float* most_variances) {
      for (uint32_t i = 0; i < kTileSize; i += kLanes) {
        store_lanes(squared + i, load_lanes(squared + i) + load_lanes(squares + i));
        store_lanes(variance + i, load_lanes(variance + i) + load_lanes(variances + i));
        const Lanes most = load_lanes(most_squared + i);
        const Lanes other = load_lanes(most_squares + i);
        store_lanes(most_variance + i,
                    select(most < other, load_lanes(most_variances + i), load_lanes(most_variance + i)));
        store_lanes(most_squared + i, select(most < other, other, most));
      }
    }
  };

  /// Differences of kTileSize pixels from (x0, y) on, each summed over its neighbours in the row.
  SumsOfRow row_around(uint32_t x0, uint32_t y) const {
    float squares[kPaddedEdge] = {};
    float variances[kPaddedEdge] = {};
    float most_variances[kPaddedEdge] = {};
    const bool inside_image = x0 >= kReach && x0 - kReach + kPaddedEdge <= width;
    for (uint32_t i = 0; inside_image && i < kPaddedEdge; i += kLanes)
      at(y * width + x0 + i - kReach, squares + i, variances + i, most_variances + i);
    for (uint32_t i = inside_image ? kEdge : x0 < kReach ? kReach - x0 : 0; i < kEdge && x0 + i - kReach < width; ++i) {
      const Difference d = at(y * width + x0 + i - kReach);
      squares[i] = d.squared;
      variances[i] = d.variance;
      most_variances[i] = d.most_variance;
    }
    SumsOfRow row = {};
    for (uint32_t k = 0; k <= 2 * kReach; ++k) row.add(squares + k, variances + k, squares + k, most_variances + k);
    return row;
  }

  /// The variance of a mean of stratified samples falls about as n^(−3/2), not as n⁻¹, which the estimate assumes. Few
  /// samples are not assumed to be stratified: light found by one of eight is not.
  RELUME_HD Difference at(uint32_t pixel) const {
    if (samples[pixel] < kKnownSamples) return {};
    const auto n = static_cast<float>(static_cast<int>(samples[pixel]));
    const float gain = stratified && n > kStratifiedSamples ? std::sqrt(kStratifiedSamples / n) : 1.0f;
    const float squared = sqr(luminance(mean[pixel] - image[pixel]));
    const float variance = m2[pixel] / (n * (n - 1.0f));
    return {squared, gain * variance, squared, (1.0f - gain) * variance};
  }

  /// The same for kLanes pixels from `pixel` on.
  void at(uint32_t pixel, float* squares, float* variances, float* most_variances) const {
    float counts[kLanes];
    for (uint32_t k = 0; k < kLanes; ++k) counts[k] = static_cast<float>(static_cast<int>(samples[pixel + k]));
    const Lanes least(static_cast<float>(kKnownSamples));
    const Lanes one(1.0f);
    const Lanes known = select(load_lanes(counts) < least, Lanes(0.0f), one);
    const Lanes n = max(load_lanes(counts), least);
    const Lanes many(kStratifiedSamples);
    const Lanes gain = stratified ? square_root(many / max(n, many)) : one;
    Lanes of_mean[3];
    Lanes of_image[3];
    load_vectors(&mean[pixel].r, of_mean);
    load_vectors(&image[pixel].r, of_image);
    const Lanes difference = luminance(of_mean[0] - of_image[0], of_mean[1] - of_image[1], of_mean[2] - of_image[2]);
    const Lanes variance = known * (load_lanes(&m2[pixel]) / (n * (n - one)));
    store_lanes(squares, known * (difference * difference));
    store_lanes(variances, gain * variance);
    store_lanes(most_variances, (one - gain) * variance);
  }

  RELUME_HD void finish(uint32_t pixel, const Difference& around) const {
    const float variance = around.variance + around.most_variance;
    float share = around.squared > 0.0f ? 1.0f - variance / around.squared : 0.0f;
    if (!(share > 0.0f) || samples[pixel] < kKnownSamples) share = 0.0f;
    // Samples that miss some of the shown emission may leave a mean slightly below black at edges.
    converged[pixel] = glm::max(image[pixel] + (mean[pixel] - image[pixel]) * share, Rgb(0));
  }
};

}  // namespace relume
