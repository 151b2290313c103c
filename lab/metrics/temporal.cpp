#include "metrics/temporal.h"

#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "core/vec.h"
#include "relume/error.h"
#include "relume/lab/metrics.h"

namespace relume {
namespace {

constexpr float kDepthTolerance = 0.1f;
constexpr float kNormalCosine = 0.906f;  // 25°

void check_planes(const Image& image, const SurfaceMotion& surface) {
  const size_t count = image.pixels.size();
  if (surface.motion.size() == count && surface.depth.size() == count && surface.normal.size() == count) return;
  throw Error(fmt::format(
      "motion, depth and normal have {}, {} and {} pixels, but the image has {}; give each one value per pixel",
      surface.motion.size(), surface.depth.size(), surface.normal.size(), count));
}

/// Index of the pixel that showed the surface of pixel (x, y) in the previous frame.
std::optional<size_t> pixel_before(const Image& image, const SurfaceMotion& surface, const SurfaceMotion& previous,
                                   int x, int y) {
  const size_t i = static_cast<size_t>(y) * static_cast<size_t>(image.width) + static_cast<size_t>(x);
  const Vec2 position = Vec2(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f) - surface.motion[i];
  const float column = std::floor(position.x);
  const float row = std::floor(position.y);
  // In this form, so that NaN is rejected.
  if (!(column >= 0 && row >= 0 && column < static_cast<float>(image.width) && row < static_cast<float>(image.height)))
    return std::nullopt;
  const size_t q = static_cast<size_t>(row) * static_cast<size_t>(image.width) + static_cast<size_t>(column);
  const bool is_background = !(surface.depth[i] > 0);
  if (is_background != !(previous.depth[q] > 0)) return std::nullopt;
  if (is_background) return q;
  if (std::fabs(surface.depth[i] - previous.depth[q]) > kDepthTolerance * surface.depth[i]) return std::nullopt;
  const float cosine = glm::dot(surface.normal[i], previous.normal[q]);
  if (cosine < kNormalCosine * glm::length(surface.normal[i]) * glm::length(previous.normal[q])) return std::nullopt;
  return q;
}

/// Means of `squares(i, q)` over finite pixels i whose surface pixel q of the previous frame shows.
template <typename Squares>
TemporalError mean_over_surfaces(const Image& reference, const SurfaceMotion& surface,
                                 const SurfaceMotion& previous_surface, const Squares& squares) {
  check_planes(reference, surface);
  check_planes(reference, previous_surface);
  TemporalError result;
  for (int y = 0; y < reference.height; ++y) {
    for (int x = 0; x < reference.width; ++x) {
      const std::optional<size_t> q = pixel_before(reference, surface, previous_surface, x, y);
      if (!q) continue;
      const size_t i = static_cast<size_t>(y) * static_cast<size_t>(reference.width) + static_cast<size_t>(x);
      const glm::dvec3 square = squares(i, *q);
      const glm::dvec3 now(reference.pixels[i]);
      if (!std::isfinite(square.x + square.y + square.z) || !is_finite(reference.pixels[i])) continue;
      ++result.pixels;
      for (int c = 0; c < 3; ++c) {
        result.mse += square[c];
        result.rel_mse += square[c] / (now[c] * now[c] + kRelativeEpsilon);
      }
    }
  }
  if (result.pixels == 0) return result;
  result.mse /= 3.0 * static_cast<double>(result.pixels);
  result.rel_mse /= 3.0 * static_cast<double>(result.pixels);
  return result;
}

}  // namespace

TemporalError temporal_error(const Image& image, const Image& reference, const SurfaceMotion& surface,
                             const Image& previous_image, const Image& previous_reference,
                             const SurfaceMotion& previous_surface) {
  check_same_size(image, reference);
  check_same_size(image, previous_image);
  check_same_size(image, previous_reference);
  return mean_over_surfaces(reference, surface, previous_surface, [&](size_t i, size_t q) {
    const Rgb now = image.pixels[i] - reference.pixels[i];
    const Rgb change = now - (previous_image.pixels[q] - previous_reference.pixels[q]);
    return glm::dvec3(change) * glm::dvec3(change);
  });
}

TemporalError temporal_noise(const Image& reference, const Image& squared_error, const SurfaceMotion& surface,
                             const Image& previous_squared_error, const SurfaceMotion& previous_surface) {
  check_same_size(reference, squared_error);
  check_same_size(reference, previous_squared_error);
  return mean_over_surfaces(reference, surface, previous_surface, [&](size_t i, size_t q) {
    return glm::dvec3(squared_error.pixels[i]) + glm::dvec3(previous_squared_error.pixels[q]);
  });
}

}  // namespace relume
