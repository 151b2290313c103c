// Histories of denoisers: the light at each pixel's surface, accumulated over frames along the surface's motion.
#pragma once

#include "techniques/gbuffer/features/features.h"
#include "techniques/temporal/reprojection/backward_row.h"

namespace relume {

/// Light at a pixel's surface by this frame's sample.
struct SurfaceLightSample {
  Rgb light{0};
  bool valid = false;  ///< false: no sample in this frame, nothing to filter, or not finite
};

/// Views of this frame's samples and features.
struct SurfaceLight {
  View<const Rgb> radiance;
  View<const Rgb> scattered;        ///< radiance without the sample's emission
  View<const uint32_t> allocation;  ///< samples of the pixel in this frame, 0 or 1; empty: 1 everywhere
  View<const Rgb> albedo;
  View<const Rgb> emission;       ///< emission that the image shows
  View<const Rgb> caustics = {};  ///< caustic layer, filtered separately and not part of `scattered`; may be empty

  RELUME_HD bool taken(uint32_t pixel) const { return allocation.empty() || allocation[pixel] != 0; }

  RELUME_HD SurfaceLightSample at(uint32_t pixel) const {
    if (!taken(pixel) || !is_filtered(albedo[pixel]) || !is_finite(scattered[pixel])) return {};
    return {light_at_surface(scattered[pixel], albedo[pixel]), true};
  }

  /// Samples of kLanes pixels, from `pixel` on. `valid`: as in SurfaceLightSample.
  RELUME_HD_INLINE Triple<Lanes> at(uint32_t pixel, LaneMask& valid) const {
    const Triple<Lanes> light = vector_at<Lanes>(scattered, pixel);
    const Triple<Lanes> reflected = vector_at<Lanes>(albedo, pixel);
    valid = is_filtered(reflected) & is_usable(pixel, light);
    return select(valid, light_at_surface(light, reflected), triple_of<Lanes>(Vec3(0)));
  }

  /// The image from filtered light. Unfiltered pixels show this frame's sample or, without one, their emission. Samples
  /// that miss some emission leave negative light, which is clamped to black.
  RELUME_HD Rgb image(uint32_t pixel, const Rgb& light) const {
    if (is_filtered(albedo[pixel])) {
      const Rgb surface = emission[pixel] + albedo[pixel] * light;
      return glm::max(caustics.empty() ? surface : surface + caustics[pixel], Rgb(0));
    }
    return taken(pixel) && is_finite(radiance[pixel]) ? radiance[pixel] : emission[pixel];
  }

  /// The same for kLanes pixels, from `pixel` on.
  RELUME_HD_INLINE Triple<Lanes> image(uint32_t pixel, const Triple<Lanes>& light) const {
    const Triple<Lanes> reflected = vector_at<Lanes>(albedo, pixel);
    const Triple<Lanes> emitted = vector_at<Lanes>(emission, pixel);
    const Triple<Lanes> sample = vector_at<Lanes>(radiance, pixel);
    Triple<Lanes> surface = emitted + product_of(reflected, light);
    if (!caustics.empty()) surface = surface + vector_at<Lanes>(caustics, pixel);
    const Triple<Lanes> black = triple_of<Lanes>(Vec3(0));
    return select<Lanes>(is_filtered(reflected), max_of(surface, black),
                         select(is_usable(pixel, sample), sample, emitted));
  }

 private:
  /// Whether the samples of kLanes pixels from `pixel` on were taken and have finite `values`.
  RELUME_HD_INLINE LaneMask is_usable(uint32_t pixel, const Triple<Lanes>& values) const {
    const Lanes most(3.402823466e+38f);
    const LaneMask finite = (absolute(values.x) <= most) & (absolute(values.y) <= most) & (absolute(values.z) <= most);
    if (allocation.empty()) return finite;
    return finite & mask_of([&](uint32_t i) { return allocation[pixel + i] != 0; });
  }
};

/// The two parts of this frame's samples if they are kept apart.
struct SplitLight {
  SurfaceLight diffuse;
  View<const Rgb> specular_albedo;

  RELUME_HD bool reflects(uint32_t pixel) const { return is_filtered(specular_albedo[pixel]); }

  /// reflects() of kLanes pixels, from `pixel` on.
  RELUME_HD_INLINE LaneMask reflecting(uint32_t pixel) const {
    return is_filtered(vector_at<Lanes>(specular_albedo, pixel));
  }

  /// Reflection of filtered light by specular lobes. Requires reflects().
  RELUME_HD Rgb specular_part(uint32_t pixel, const Rgb& light) const {
    return glm::max(specular_albedo[pixel] * light, Rgb(0));
  }

  /// The same for kLanes pixels, from `pixel` on; black in those that do not reflect.
  RELUME_HD_INLINE Triple<Lanes> specular_part(uint32_t pixel, const Triple<Lanes>& light) const {
    const Triple<Lanes> black = triple_of<Lanes>(Vec3(0));
    const Triple<Lanes> reflected = product_of(vector_at<Lanes>(specular_albedo, pixel), light);
    return select(reflecting(pixel), max_of(reflected, black), black);
  }

  /// The image from filtered diffuse light and the result of specular_part().
  RELUME_HD Rgb image(uint32_t pixel, const Rgb& light, const Rgb& specular) const {
    if (is_filtered(diffuse.albedo[pixel])) return diffuse.image(pixel, light) + specular;
    if (reflects(pixel)) return diffuse.emission[pixel] + specular;
    return diffuse.image(pixel, light);
  }

  /// The same for kLanes pixels, from `pixel` on.
  RELUME_HD_INLINE Triple<Lanes> image(uint32_t pixel, const Triple<Lanes>& light,
                                       const Triple<Lanes>& specular) const {
    const Triple<Lanes> whole = diffuse.image(pixel, light);
    const Triple<Lanes> mirror = select(reflecting(pixel), vector_at<Lanes>(diffuse.emission, pixel) + specular, whole);
    return select(is_filtered(vector_at<Lanes>(diffuse.albedo, pixel)), whole + specular, mirror);
  }
};

/// Edge of the blocks in which changes of light are detected, pixels.
inline constexpr uint32_t kChangeBlock = 8;
RELUME_HD constexpr uint32_t change_blocks(uint32_t size) { return (size + kChangeBlock - 1) / kChangeBlock; }

inline constexpr uint32_t kNoHistoryLimit = 1u << 24;  ///< larger counts are not exact as floats

/// Number of samples, rounded, for which a history of `age` samples counts if the next one weighs (1 − λ) α + λ and not
/// only α = 1 / (age + 1), in their common mean ([Schied18]). `lambda`: λ, in [0, 1].
RELUME_HD inline uint32_t adapted_age(uint32_t age, float lambda) {
  if (!(lambda > 0.0f)) return age;
  const auto samples = static_cast<float>(age);
  return static_cast<uint32_t>((1.0f - lambda) * samples / (1.0f + lambda * samples) + 0.5f);
}

/// A pixel's history and its sample of this frame, for averages of any property of its samples.
struct PixelHistory {
  BackwardTaps taps;
  SurfaceLightSample sample;
  uint32_t age = 0;       ///< sample count of the history
  float least_share = 0;  ///< least weight of this frame's sample in the mean

  /// Samples, including this frame's.
  RELUME_HD uint32_t count() const { return age + (sample.valid ? 1u : 0u); }

  /// Value of the previous frame's buffer at the surface's previous position; zero without a history.
  template <typename T>
  RELUME_HD T past(const View<const T>& before) const {
    return age > 0 ? taps.fetch(before) : T(0);
  }

  /// Mean over all samples, from the previous frame's mean and this frame's `value`, which counts only with a valid
  /// sample.
  template <typename T>
  RELUME_HD T mean(const View<const T>& before, const T& value) const {
    T result = past(before);
    if (!sample.valid) return result;
    const float share = relume::max(1.0f / static_cast<float>(count()), least_share);
    result += (value - result) * share;
    return result;
  }
};

/// PixelHistory of kLanes pixels in a row.
struct RowHistory {
  RowTaps taps;
  Triple<Lanes> light;  ///< of this frame's samples
  LaneMask sampled;     ///< SurfaceLightSample::valid
  uint32_t age[kLanes];
  Lanes share;  ///< weight of this frame's sample in the mean

  RELUME_HD_INLINE LaneMask has_past() const {
    return mask_of([this](uint32_t i) { return age[i] > 0; });
  }
  RELUME_HD_INLINE Triple<Lanes> mean(const View<const Vec3>& before, const Triple<Lanes>& value) const {
    const Triple<Lanes> past = select(has_past(), taps.fetch(before), triple_of<Lanes>(Vec3(0)));
    return select(sampled, past + (value - past) * share, past);
  }
  /// The same for pairs. Replaces `values`.
  RELUME_HD_INLINE void mean(const View<const Vec2>& before, Lanes (&values)[2]) const {
    Lanes past[2];
    taps.fetch(before, past);
    for (int i = 0; i < 2; ++i) {
      past[i] = select(has_past(), past[i], Lanes(0.0f));
      values[i] = select(sampled, past[i] + (values[i] - past[i]) * share, past[i]);
    }
  }
};

/// Accumulates the light at the pixels' surfaces: common part of the first kernels of denoisers.
struct LightHistory {
  BackwardReprojection reprojection;
  SurfaceLight samples;
  View<const Rgb> light_before;
  View<const uint32_t> count_before;
  View<Rgb> light;                         ///< mean of the samples
  View<uint32_t> count;                    ///< number of samples in `light`
  uint32_t max_samples = kNoHistoryLimit;  ///< maximum sample count of the history
  float least_share = 0;  ///< least weight of a frame's sample in the mean; 0: all samples have equal weights
  /// Per block with changed light, 1 / maximum sample count of the history (light_change.h); 0: no change. Empty: no
  /// change anywhere.
  View<const float> discounts;
  /// Per pixel, λ of adapted_age(); empty: 0 everywhere.
  View<const float> lambdas = {};

  RELUME_HD uint32_t pixel(uint32_t x, uint32_t y) const { return y * reprojection.width + x; }

  RELUME_HD uint32_t limit_at(uint32_t x, uint32_t y) const {
    if (discounts.empty()) return max_samples;
    const float discount = discount_at(x, y);
    return discount * static_cast<float>(max_samples) > 1.0f ? static_cast<uint32_t>(1.0f / discount) : max_samples;
  }

  /// Sample count of the history of pixel (x, y) if it has `past` samples.
  RELUME_HD uint32_t age_at(uint32_t x, uint32_t y, uint32_t past) const {
    const uint32_t age = relume::min(past, limit_at(x, y));
    return lambdas.empty() ? age : adapted_age(age, lambdas[pixel(x, y)]);
  }

  /// Interpolates between the centres of blocks.
  RELUME_HD float discount_at(uint32_t x, uint32_t y) const {
    const uint32_t columns = change_blocks(reprojection.width);
    const uint32_t rows = change_blocks(reprojection.height);
    const float u = relume::max((static_cast<float>(x) + 0.5f) / kChangeBlock - 0.5f, 0.0f);
    const float v = relume::max((static_cast<float>(y) + 0.5f) / kChangeBlock - 0.5f, 0.0f);
    const auto x0 = static_cast<uint32_t>(u);
    const auto y0 = static_cast<uint32_t>(v);
    const uint32_t x1 = relume::min(x0 + 1u, columns - 1u);
    const uint32_t y1 = relume::min(y0 + 1u, rows - 1u);
    const float wx = u - static_cast<float>(x0);
    const float wy = v - static_cast<float>(y0);
    const auto row = [&](uint32_t k) {
      return discounts[k * columns + x0] * (1.0f - wx) + discounts[k * columns + x1] * wx;
    };
    return row(y0) * (1.0f - wy) + row(y1) * wy;
  }

  /// Updates the light of pixel (x, y). Black texels also carry the history of their surroundings. Background pixels
  /// have no history.
  RELUME_HD PixelHistory accumulate(uint32_t x, uint32_t y) const {
    const uint32_t i = pixel(x, y);
    PixelHistory history;
    history.sample = samples.at(i);
    if (reprojection.surface[i] != kNoSurface) history.taps = reprojection.taps_or_nearest(x, y, count_before);
    history.age = age_at(x, y, history.taps.least(count_before));
    history.least_share = least_share;
    light[i] = history.mean(light_before, history.sample.light);
    count[i] = history.count();
    return history;
  }

  /// The same for kLanes pixels from (x, y) on. Returns false, and changes nothing, if they must be updated one by one.
  RELUME_HD_INLINE bool accumulate(uint32_t x, uint32_t y, RowHistory& row) const {
    const uint32_t first = pixel(x, y);
    if (are_unlit(x, y)) {
      row = RowHistory();
      for (uint32_t i = 0; i < kLanes; ++i) count[first + i] = 0;
      set_vector(light, first, row.light);
      return true;
    }
    if (!find_taps(reprojection, x, y, count_before, row.taps)) return false;
    row.light = samples.at(first, row.sampled);
    uint32_t past[kLanes];
    row.taps.least(count_before, past);
    for (uint32_t i = 0; i < kLanes; ++i) {
      const bool background = reprojection.surface[first + i] == kNoSurface;
      row.age[i] = background ? 0u : age_at(x + i, y, past[i]);
      const uint32_t samples_now = row.age[i] + (row.sampled.b[i] != 0 ? 1u : 0u);
      count[first + i] = samples_now;
      row.share.v[i] = relume::max(1.0f / static_cast<float>(samples_now), least_share);
    }
    set_vector(light, first, row.mean(light_before, row.light));
    return true;
  }

 private:
  /// Whether kLanes pixels from (x, y) on have neither samples nor a history: none is filtered, and no pixel that
  /// taps_or_nearest() reads has samples. Most surfaces have no specular light, and each would search its neighbours.
  RELUME_HD_INLINE bool are_unlit(uint32_t x, uint32_t y) const {
    if (any_of(is_filtered(vector_at<Lanes>(samples.albedo, pixel(x, y))))) return false;
    RowOrigin origin;
    if (!find_row(reprojection.motion, reprojection.width, x, y, origin)) return false;
    // The nearest pixel lies up to one right of or below a position, and its neighbours one further.
    const auto clip = [](int i, uint32_t size) { return i < 0 ? 0u : relume::min(static_cast<uint32_t>(i), size); };
    const uint32_t right = clip(origin.x + static_cast<int>(kLanes) + 2, reprojection.width);
    const uint32_t bottom = clip(origin.y + 3, reprojection.height);
    uint32_t samples_before = 0;
    for (uint32_t row = clip(origin.y - 1, bottom); row < bottom; ++row) {
      for (uint32_t column = clip(origin.x - 1, right); column < right; ++column)
        samples_before |= count_before[row * reprojection.width + column];
    }
    return samples_before == 0;
  }
};

}  // namespace relume
