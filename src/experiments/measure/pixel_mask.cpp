#include "experiments/measure/pixel_mask.h"

#include <algorithm>

namespace relume {

size_t PixelMask::pixels() const {
  return mask.size() - static_cast<size_t>(std::count(mask.begin(), mask.end(), uint8_t{0}));
}

double frame_mse(const Image& frame, const Image& reference, const PixelMask& region) {
  double sum = 0;
  for (size_t p = 0; p < frame.pixels.size(); ++p) {
    if (region.mask[p] == 0) continue;
    const glm::dvec3 d = glm::dvec3(frame.pixels[p]) - glm::dvec3(reference.pixels[p]);
    sum += glm::dot(d, d);
  }
  return sum / (3.0 * static_cast<double>(std::max<size_t>(region.pixels(), 1)));
}

double reference_noise(const Reference& reference, const PixelMask& region) {
  double sum = 0;
  for (size_t p = 0; p < reference.squared_error.pixels.size(); ++p) {
    if (region.mask[p] == 0) continue;
    for (int c = 0; c < 3; ++c) sum += static_cast<double>(reference.squared_error.pixels[p][c]);
  }
  return sum / (3.0 * static_cast<double>(std::max<size_t>(region.pixels(), 1)));
}

}  // namespace relume
