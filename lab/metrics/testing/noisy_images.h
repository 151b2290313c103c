// Small images with known bias and noise.
#pragma once

#include <vector>

#include "core/hash.h"
#include "relume/image_io.h"

namespace relume::testing {

/// Nearly normal noise of variance 1.
inline float noise(uint32_t seed, uint32_t i) {
  float sum = -6;
  for (uint32_t k = 0; k < 12; ++k) sum += to_unit_float(hash(seed, i, k));
  return sum;
}

/// Images of value 1 + bias with noise of standard deviation `spread`.
inline std::vector<Image> repetitions(int count, float bias, float spread, uint32_t seed) {
  std::vector<Image> list;
  for (int r = 0; r < count; ++r) {
    Image image(16, 16);
    uint32_t i = 0;
    for (Rgb& p : image.pixels) {
      for (int c = 0; c < 3; ++c) p[c] = 1 + bias + spread * noise(seed + static_cast<uint32_t>(r), i++);
    }
    list.push_back(std::move(image));
  }
  return list;
}

/// The image without bias and noise.
inline Image reference() {
  Image image(16, 16);
  for (Rgb& p : image.pixels) p = Rgb(1);
  return image;
}

}  // namespace relume::testing
