// Renders and measures small scenes, for tests with known results.
#pragma once

#include "relume/image_io.h"
#include "render/render_settings.h"
#include "scene/scene.h"

namespace relume::support {

/// Small settings on one thread, so that tests may run in parallel.
RenderSettings small_settings(int width, int height);

/// Renders `spp` samples per pixel.
Image render(Scene scene, const RenderSettings& settings, int spp);

/// Mean over all pixels of an image, and its standard error from the deviation of the pixels, whose samples are
/// independent.
struct Estimate {
  Rgb mean{0};
  Rgb standard_error{0};
};
Estimate estimate_of(const Image& image);

/// Mean luminance over all pixels.
double mean_luminance(const Image& image);
/// Mean squared difference over pixels and channels.
double mse(const Image& a, const Image& b);

/// Expects `estimate` to equal `expected` within the relative `tolerance` in every channel. The standard error must be
/// at most a third of the tolerance, for a significant result. Black is expected exactly.
void expect_near(const Estimate& estimate, const Rgb& expected, double tolerance);

/// Mean and variance of every pixel over images with seeds first_seed, first_seed + 1, ….
struct Moments {
  int width = 0;
  int height = 0;
  int count = 0;              ///< number of images
  std::vector<Rgb> mean;      ///< in rows
  std::vector<Rgb> variance;  ///< unbiased, of one image
  std::vector<Image> images;

  Image mean_image() const;
};
Moments measure(const Scene& scene, const RenderSettings& settings, int spp, int count, int first_seed);
Moments moments_of(std::vector<Image> images);

}  // namespace relume::support
