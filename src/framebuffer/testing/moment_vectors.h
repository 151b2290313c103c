// Pixel moments stored in vectors.
#pragma once

#include <vector>

#include "framebuffer/pixel_moments.h"

namespace relume::testing {

struct MomentVectors {
  explicit MomentVectors(size_t pixels, const PixelMoments& value = {})
      : mean(pixels, value.mean), m2(pixels, value.m2), m2_rgb(pixels, value.m2_rgb), samples(pixels, value.samples) {}

  MomentsView view() const { return {view_of(mean), view_of(m2), view_of(m2_rgb), view_of(samples)}; }
  MutableMomentsView mutable_view() {
    return {mutable_view_of(mean), mutable_view_of(m2), mutable_view_of(m2_rgb), mutable_view_of(samples)};
  }

  std::vector<Rgb> mean;
  std::vector<float> m2;
  std::vector<float> m2_rgb;
  std::vector<uint32_t> samples;
};

}  // namespace relume::testing
