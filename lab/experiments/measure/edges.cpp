#include "experiments/measure/edges.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "metrics/statistics.h"

namespace relume {
namespace {

constexpr float kDepthDifference = 0.1f;
constexpr float kNormalCosine = 0.9f;
constexpr float kLightRatio = 1.3f;
constexpr float kStandardErrors = 3;

double mean_of_channels_at(const Image& image, size_t pixel) {
  const glm::dvec3 value(image.pixels[pixel]);
  return (value.r + value.g + value.b) / 3;
}

bool is_other_surface(const SurfaceMotion& surface, size_t a, size_t b) {
  const Vec3 nothing(0);  // the normal where no surface is visible
  if (surface.normal[a] == nothing && surface.normal[b] == nothing) return false;
  const float near = std::min(surface.depth[a], surface.depth[b]);
  const float far = std::max(surface.depth[a], surface.depth[b]);
  return far - near > kDepthDifference * near || glm::dot(surface.normal[a], surface.normal[b]) < kNormalCosine;
}

bool is_other_light(const Reference& reference, size_t a, size_t b) {
  const float light_a = luminance(reference.image.pixels[a]);
  const float light_b = luminance(reference.image.pixels[b]);
  if (std::max(light_a, light_b) < kLightRatio * std::min(light_a, light_b)) return false;
  if (reference.squared_error.pixels.empty()) return light_a != light_b;
  const float squares = luminance(reference.squared_error.pixels[a]) + luminance(reference.squared_error.pixels[b]);
  return std::fabs(light_a - light_b) > kStandardErrors * std::sqrt(squares);
}

/// Pixels for which `differs(pixel, neighbour)` holds with one of four neighbours.
template <typename Differs>
PixelMask mask_where(const char* name, const Image& image, const Differs& differs) {
  const auto width = static_cast<size_t>(image.width);
  const auto height = static_cast<size_t>(image.height);
  PixelMask mask{name, std::vector<uint8_t>(width * height, 0)};
  for (size_t p = 0; p < mask.mask.size(); ++p) {
    const size_t x = p % width;
    const size_t y = p / width;
    const bool is_edge = (x > 0 && differs(p, p - 1)) || (x + 1 < width && differs(p, p + 1)) ||
                         (y > 0 && differs(p, p - width)) || (y + 1 < height && differs(p, p + width));
    mask.mask[p] = is_edge ? 1 : 0;
  }
  return mask;
}

}  // namespace

PixelMask depth_edges(const Reference& reference) {
  return mask_where("depth edges", reference.image,
                    [&](size_t a, size_t b) { return is_other_surface(reference.surface, a, b); });
}

PixelMask shadow_edges(const Reference& reference) {
  const PixelMask depth = depth_edges(reference);
  return mask_where("shadow edges", reference.image, [&](size_t a, size_t b) {
    return depth.mask[a] == 0 && !is_other_surface(reference.surface, a, b) && is_other_light(reference, a, b);
  });
}

std::vector<size_t> pixels_in(const PixelMask& mask) {
  std::vector<size_t> pixels;
  for (size_t p = 0; p < mask.mask.size(); ++p) {
    if (mask.mask[p] != 0) pixels.push_back(p);
  }
  return pixels;
}

std::vector<EdgeBlock> blocks_of(const PixelMask& mask, int width, int height, int size, size_t least) {
  std::vector<EdgeBlock> blocks;
  for (int y = 0; y < height; y += size) {
    for (int x = 0; x < width; x += size) {
      EdgeBlock block{x, y, {}};
      for (int v = y; v < std::min(y + size, height); ++v) {
        for (int u = x; u < std::min(x + size, width); ++u) {
          const size_t p = static_cast<size_t>(v) * static_cast<size_t>(width) + static_cast<size_t>(u);
          if (mask.mask[p] != 0) block.pixels.push_back(p);
        }
      }
      if (block.pixels.size() >= least) blocks.push_back(std::move(block));
    }
  }
  return blocks;
}

BlockBias block_bias(const std::vector<Image>& runs, const Reference& reference, const std::vector<size_t>& pixels) {
  const auto mean_of_pixels = [&](const Image& image) {
    double sum = 0;
    for (const size_t p : pixels) sum += mean_of_channels_at(image, p);
    return sum / static_cast<double>(std::max<size_t>(pixels.size(), 1));
  };
  std::vector<double> means;
  for (const Image& image : runs) means.push_back(mean_of_pixels(image));
  BlockBias result{mean_of_pixels(reference.image), 0, 0};
  result.bias = mean(means) - result.reference;
  // Errors of pixels are independent in the reference. Those of a pixel's channels may be equal.
  const double noise =
      reference.squared_error.pixels.empty()
          ? 0
          : mean_of_pixels(reference.squared_error) / static_cast<double>(std::max<size_t>(pixels.size(), 1));
  const double deviation = standard_deviation(means);
  result.error = std::sqrt(deviation * deviation / static_cast<double>(std::max<size_t>(means.size(), 1)) + noise);
  return result;
}

}  // namespace relume
