#include "relume/lab/flip.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/matrix.hpp>

#include "metrics/flip_filters.h"
#include "relume/lab/metrics.h"

namespace relume {
namespace {

// [Andersson20 §4.1.3, §4.3].
constexpr float kColorExponent = 0.7f;    // q_c
constexpr float kFeatureExponent = 0.5f;  // q_f
constexpr float kKneeInput = 0.4f;        // p_c
constexpr float kKneeOutput = 0.95f;      // p_t

/// [Andersson21 §4]: display value to which the brightest and the median pixel are exposed.
constexpr float kExposureTarget = 0.85f;
constexpr float kMaxRadiance = 65536.0f;
constexpr float kMaxStops = 30.0f;

/// Linear Rec. 709 to CIE XYZ with the white of the published implementation; columns.
const Mat3 kXyzFromRgb(0.41238656f, 0.21263682f, 0.01933062f, 0.35759149f, 0.71518298f, 0.11919716f, 0.18045049f,
                       0.07218020f, 0.95037259f);
const Mat3 kRgbFromXyz = glm::inverse(kXyzFromRgb);
const Vec3 kWhite = kXyzFromRgb * Vec3(1.0f);

/// [Andersson20 §4.1.1]: linearised L*a*b* (Y, Cx, Cz).
Vec3 opponent_from_rgb(const Rgb& rgb) {
  const Vec3 xyz = kXyzFromRgb * rgb / kWhite;
  return {116.0f * xyz.y - 16.0f, 500.0f * (xyz.x - xyz.y), 200.0f * (xyz.y - xyz.z)};
}

Rgb rgb_from_opponent(const Vec3& c) {
  const float y = (c.x + 16.0f) / 116.0f;
  return kRgbFromXyz * (Vec3(y + c.y / 500.0f, y, y - c.z / 200.0f) * kWhite);
}

/// CIE 1976 L*a*b* with its linear toe.
Vec3 lab_from_rgb(const Rgb& rgb) {
  constexpr float kDelta = 6.0f / 29.0f;
  Vec3 f = kXyzFromRgb * rgb / kWhite;
  for (int i = 0; i < 3; ++i)
    f[i] = f[i] > kDelta * kDelta * kDelta ? std::cbrt(f[i]) : f[i] / (3.0f * kDelta * kDelta) + 4.0f / 29.0f;
  return {116.0f * f.y - 16.0f, 500.0f * (f.x - f.y), 200.0f * (f.y - f.z)};
}

/// Hunt effect: colourfulness grows with lightness.
Vec3 hunt_adjusted_lab(const Rgb& rgb) {
  const Vec3 lab = lab_from_rgb(rgb);
  return {lab.x, 0.01f * lab.x * lab.y, 0.01f * lab.x * lab.z};
}

/// HyAB distance, raised to q_c.
float color_distance(const Vec3& a, const Vec3& b) {
  const Vec3 d = a - b;
  return std::pow(std::fabs(d.x) + std::sqrt(sqr(d.y) + sqr(d.z)), kColorExponent);
}

/// Compresses large distances: maps the first p_c of the range to p_t of the output.
float redistribute(float distance, float max_distance) {
  const float knee = kKneeInput * max_distance;
  if (distance < knee) return kKneeOutput / knee * distance;
  return kKneeOutput + (distance - knee) / (max_distance - knee) * (1.0f - kKneeOutput);
}

struct Perceived {
  std::vector<Vec3> color;     ///< filtered, Hunt-adjusted L*a*b*
  std::vector<Vec2> features;  ///< edges, points
};

Rgb in_unit_cube(const Rgb& c) { return glm::clamp(c, Vec3(0.0f), Vec3(1.0f)); }

/// `shown` must be within [0, 1].
Perceived perceive(const std::vector<Rgb>& shown, int width, int height, const detail::ContrastKernel& contrast,
                   const detail::FeatureKernel& feature) {
  std::vector<Vec3> opponent(shown.size());
  std::vector<float> lightness(shown.size());
  detail::for_each_row(height, [&](int y) {
    const size_t begin = static_cast<size_t>(y) * static_cast<size_t>(width);
    for (size_t i = begin; i < begin + static_cast<size_t>(width); ++i) {
      opponent[i] = opponent_from_rgb(shown[i]);
      lightness[i] = (opponent[i].x + 16.0f) / 116.0f;
    }
  });
  Perceived result;
  result.features = detail::detect_features(lightness, width, height, feature);
  result.color = detail::filter_contrast(opponent, width, height, contrast);
  detail::for_each_row(height, [&](int y) {
    const auto begin = result.color.begin() + static_cast<std::ptrdiff_t>(y) * width;
    for (auto c = begin; c != begin + width; ++c) *c = hunt_adjusted_lab(in_unit_cube(rgb_from_opponent(*c)));
  });
  return result;
}

std::vector<float> compare(const std::vector<Rgb>& test, const std::vector<Rgb>& reference, int width, int height,
                           float pixels_per_degree) {
  const detail::ContrastKernel contrast = detail::contrast_kernel(pixels_per_degree);
  const detail::FeatureKernel feature = detail::feature_kernel(pixels_per_degree);
  const Perceived a = perceive(test, width, height, contrast, feature);
  const Perceived b = perceive(reference, width, height, contrast, feature);
  const float max_distance = color_distance(hunt_adjusted_lab({0, 1, 0}), hunt_adjusted_lab({0, 0, 1}));
  std::vector<float> map(test.size());
  detail::for_each_row(height, [&](int y) {
    const size_t begin = static_cast<size_t>(y) * static_cast<size_t>(width);
    for (size_t i = begin; i < begin + static_cast<size_t>(width); ++i) {
      const float color = redistribute(color_distance(a.color[i], b.color[i]), max_distance);
      const Vec2 difference = glm::abs(a.features[i] - b.features[i]);
      const float features = std::pow(std::max(difference.x, difference.y) / std::sqrt(2.0f), kFeatureExponent);
      map[i] = saturate(std::pow(color, 1.0f - std::min(features, 1.0f)));
    }
  });
  return map;
}

/// Clamps to [0, high]; NaN becomes 0.
float in_range(float x, float high) { return x > 0.0f ? std::min(x, high) : 0.0f; }
Rgb in_range(const Rgb& c, float high) { return {in_range(c.r, high), in_range(c.g, high), in_range(c.b, high)}; }

// Narkowicz's rational fit of ACES with its pre-exposure of 0.6 (Narkowicz 2016; [Andersson21 §4]).
constexpr float kN2 = 0.6f * 0.6f * 2.51f;
constexpr float kN1 = 0.6f * 0.03f;
constexpr float kD2 = 0.6f * 0.6f * 2.43f;
constexpr float kD1 = 0.6f * 0.59f;
constexpr float kD0 = 0.14f;

float narkowicz(float x) { return saturate((kN2 * x + kN1) * x / ((kD2 * x + kD1) * x + kD0)); }

/// Inverse of narkowicz().
float inverse_narkowicz(float y) {
  const float a = kN2 - y * kD2;
  const float b = kN1 - y * kD1;
  const float c = -y * kD0;
  return (-b + std::sqrt(b * b - 4.0f * a * c)) / (2.0f * a);
}

std::vector<Rgb> expose(const Image& image, float stops) {
  const float scale = std::exp2(stops);
  std::vector<Rgb> shown(image.pixels.size());
  std::transform(image.pixels.begin(), image.pixels.end(), shown.begin(), [&](const Rgb& pixel) {
    const Rgb c = scale * in_range(pixel, kMaxRadiance);
    return Rgb(narkowicz(c.r), narkowicz(c.g), narkowicz(c.b));
  });
  return shown;
}

std::vector<Rgb> shown_pixels(const Image& image) {
  std::vector<Rgb> shown(image.pixels.size());
  std::transform(image.pixels.begin(), image.pixels.end(), shown.begin(),
                 [](const Rgb& c) { return is_finite(c) ? in_range(c, 1.0f) : Rgb(0); });
  return shown;
}

}  // namespace

std::vector<float> flip_map(const Image& test, const Image& reference, float pixels_per_degree) {
  check_same_size(test, reference);
  return compare(shown_pixels(test), shown_pixels(reference), test.width, test.height, pixels_per_degree);
}

FlipExposures flip_exposures(const Image& reference) {
  std::vector<float> luminances(reference.pixels.size());
  std::transform(reference.pixels.begin(), reference.pixels.end(), luminances.begin(),
                 [](const Rgb& c) { return luminance(in_range(c, kMaxRadiance)); });
  if (luminances.empty()) return {};
  const float brightest = *std::max_element(luminances.begin(), luminances.end());
  if (!(brightest > 0.0f)) return {};
  const auto middle = luminances.begin() + static_cast<std::ptrdiff_t>((luminances.size() - 1) / 2);
  std::nth_element(luminances.begin(), middle, luminances.end());
  const float target = std::log2(inverse_narkowicz(kExposureTarget));
  FlipExposures exposures;
  exposures.start = target - std::log2(brightest);
  exposures.stop = std::min(target - std::log2(*middle), exposures.start + kMaxStops);
  exposures.count = std::max(2, static_cast<int>(std::ceil(exposures.stop - exposures.start)));
  return exposures;
}

std::vector<float> hdr_flip_map(const Image& test, const Image& reference, const FlipExposures& exposures,
                                float pixels_per_degree) {
  check_same_size(test, reference);
  std::vector<float> worst(test.pixels.size(), 0.0f);
  for (int i = 0; i < exposures.count; ++i) {
    const float t = exposures.count > 1 ? static_cast<float>(i) / static_cast<float>(exposures.count - 1) : 0.0f;
    const float stops = lerp(exposures.start, exposures.stop, t);
    const std::vector<float> map =
        compare(expose(test, stops), expose(reference, stops), test.width, test.height, pixels_per_degree);
    std::transform(map.begin(), map.end(), worst.begin(), worst.begin(),
                   [](float a, float b) { return std::max(a, b); });
  }
  return worst;
}

}  // namespace relume
