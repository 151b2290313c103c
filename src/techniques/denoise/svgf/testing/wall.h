// A wall whose light tests of SVGF prepare and filter.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

#include "techniques/denoise/svgf/svgf.h"

namespace relume::testing {

/// Light on a plane that faces the camera. A pixel is a millimetre wide.
struct Wall {
  static constexpr uint32_t kWidth = 77;  ///< not a multiple of lanes or tiles
  static constexpr uint32_t kHeight = 45;
  static constexpr uint32_t kPixels = kWidth * kHeight;

  Wall() {
    for (uint32_t i = 0; i < kPixels; ++i)
      position[i] = 0.001f * Vec3(static_cast<float>(i % kWidth), static_cast<float>(i / kWidth), 0);
  }

  SvgfPrepareKernel prepare_kernel() {
    SvgfPrepareKernel kernel;
    kernel.position = view_of(position);
    kernel.normal = view_of(normal);
    kernel.albedo = view_of(albedo);
    kernel.depth = view_of(depth);
    kernel.light = view_of(light);
    kernel.moments = view_of(moments);
    kernel.count = view_of(count);
    kernel.features = image(features);
    kernel.planes = image(planes);
    kernel.cone_spread = 0.001f;
    kernel.width = kWidth;
    kernel.height = kHeight;
    return kernel;
  }

  void prepare() {
    const SvgfPrepareKernel kernel = prepare_kernel();
    for (uint32_t y = 0; y < kHeight; ++y) {
      for (uint32_t x = 0; x < kWidth; ++x) kernel(x, y);
    }
  }

  AtrousKernel level(uint32_t step) {
    AtrousKernel kernel;
    kernel.features = image(features);
    kernel.light = image(planes);
    kernel.filtered = image(filtered);
    kernel.step = step;
    return kernel;
  }

  void filter(int levels = 5) {
    prepare();
    for (int k = 0; k < levels; ++k) {
      level(1u << k)(Tile{0, 0, kWidth, kHeight});
      planes.swap(filtered);
    }
  }

  /// A channel of the result.
  float at(uint32_t channel, uint32_t x, uint32_t y) { return *image(planes).at(channel, x, y); }

  /// Gives every pixel `samples` samples of mean 1 and variance 1.
  void make_noise(uint32_t samples) {
    std::mt19937 generator(3);
    std::exponential_distribution<float> exponential(1.0f);
    for (uint32_t i = 0; i < kPixels; ++i) {
      Vec2 sum(0);
      for (uint32_t k = 0; k < samples; ++k) {
        const float x = exponential(generator);
        sum += Vec2(x, x * x);
      }
      moments[i] = sum / static_cast<float>(samples);
      light[i] = Rgb(moments[i].x);
      count[i] = samples;
    }
  }

  double mse(float truth) {
    double sum = 0;
    for (uint32_t i = 0; i < kPixels; ++i) sum += static_cast<double>(sqr(at(1, i % kWidth, i / kWidth) - truth));
    return sum / kPixels;
  }

  static AtrousImage image(std::vector<float>& values) { return {mutable_view_of(values), kWidth, kHeight}; }

  std::vector<Vec3> position = std::vector<Vec3>(kPixels);
  std::vector<Vec3> normal = std::vector<Vec3>(kPixels, Vec3(0, 0, 1));
  std::vector<Rgb> albedo = std::vector<Rgb>(kPixels, Rgb(0.5f));
  std::vector<float> depth = std::vector<float>(kPixels, 1.0f);
  std::vector<Rgb> light = std::vector<Rgb>(kPixels, Rgb(1, 2, 3));
  std::vector<Vec2> moments = std::vector<Vec2>(kPixels, Vec2(1, 1));
  std::vector<uint32_t> count = std::vector<uint32_t>(kPixels, 16);
  std::vector<float> features = std::vector<float>(AtrousImage::size(kAtrousPlanes, kWidth, kHeight));
  std::vector<float> planes = std::vector<float>(AtrousImage::size(kAtrousChannels, kWidth, kHeight));
  std::vector<float> filtered = planes;
};

}  // namespace relume::testing
