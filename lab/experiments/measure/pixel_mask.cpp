#include "experiments/measure/pixel_mask.h"

#include <cmath>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace relume {

PixelRange pixels_of(const Rectangle& rectangle, int width, int height) {
  const auto at = [](double share, int size) {
    return std::clamp(static_cast<int>(std::lround(share * static_cast<double>(size))), 0, size);
  };
  return {at(rectangle.x0, width), at(rectangle.y0, height), at(rectangle.x1, width), at(rectangle.y1, height)};
}

size_t PixelMask::pixels() const {
  return mask.size() - static_cast<size_t>(std::count(mask.begin(), mask.end(), uint8_t{0}));
}

PixelMask mask_of(const Rectangle& rectangle, int width, int height) {
  PixelMask result{rectangle.name, std::vector<uint8_t>(static_cast<size_t>(width) * static_cast<size_t>(height), 0)};
  const PixelRange r = pixels_of(rectangle, width, height);
  for (int y = r.y0; y < r.y1; ++y) {
    for (int x = r.x0; x < r.x1; ++x)
      result.mask[static_cast<size_t>(y) * static_cast<size_t>(width) + static_cast<size_t>(x)] = 1;
  }
  return result;
}

double mean_of_channels(const Image& image, const PixelMask& region) {
  return mean_over(region, [&](size_t p) {
    const glm::dvec3 value(image.pixels[p]);
    return (value.r + value.g + value.b) / 3;
  });
}

double frame_mse(const Image& frame, const Image& reference, const PixelMask& region) {
  return mean_over(region, [&](size_t p) {
    const glm::dvec3 d = glm::dvec3(frame.pixels[p]) - glm::dvec3(reference.pixels[p]);
    return glm::dot(d, d) / 3;
  });
}

double reference_noise(const Reference& reference, const PixelMask& region) {
  return reference.squared_error.pixels.empty() ? 0 : mean_of_channels(reference.squared_error, region);
}

}  // namespace relume
