#include "support/measure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "relume/lab/metrics.h"
#include "render/session.h"

namespace relume::support {

RenderSettings small_settings(int width, int height) {
  RenderSettings settings;
  settings.width = width;
  settings.height = height;
  settings.threads = 1;
  return settings;
}

Image render(Scene scene, const RenderSettings& settings, int spp) {
  Session session(std::move(scene), settings);
  for (int i = 0; i < spp; ++i) session.render_frame();
  EXPECT_EQ(session.statistics().nonfinite_samples, 0u);
  return session.image();
}

Estimate estimate_of(const Image& image) {
  Estimate estimate;
  const double n = static_cast<double>(image.pixels.size());
  for (int c = 0; c < 3; ++c) {
    double sum = 0;
    for (const Rgb& p : image.pixels) sum += static_cast<double>(p[c]);
    const double mean = sum / n;
    double squares = 0;
    for (const Rgb& p : image.pixels)
      squares += (static_cast<double>(p[c]) - mean) * (static_cast<double>(p[c]) - mean);
    estimate.mean[c] = static_cast<float>(mean);
    estimate.standard_error[c] = static_cast<float>(std::sqrt(squares / (n * std::max(n - 1, 1.0))));
  }
  return estimate;
}

double mean_luminance(const Image& image) {
  double sum = 0;
  for (const Rgb& pixel : image.pixels) sum += static_cast<double>(luminance(pixel));
  return sum / static_cast<double>(image.pixels.size());
}

double mse(const Image& a, const Image& b) { return compute_metrics(a, b, {.flip = false}).mse; }

void expect_near(const Estimate& estimate, const Rgb& expected, double tolerance) {
  for (int c = 0; c < 3; ++c) {
    const double bound = tolerance * static_cast<double>(expected[c]);
    EXPECT_NEAR(estimate.mean[c], expected[c], bound)
        << "channel " << c << ", standard error " << estimate.standard_error[c];
    EXPECT_LE(estimate.standard_error[c], bound / 3) << "too noisy to tell, channel " << c;
  }
}

Image Moments::mean_image() const {
  Image image(width, height);
  image.pixels = mean;
  return image;
}

Moments measure(const Scene& scene, const RenderSettings& settings, int spp, int count, int first_seed) {
  std::vector<Image> images;
  Session session(scene, settings);
  for (int i = 0; i < count; ++i) {
    session.restart(first_seed + i);
    for (int frame = 0; frame < spp; ++frame) session.render_frame();
    EXPECT_EQ(session.statistics().nonfinite_samples, 0u) << "seed " << first_seed + i;
    images.push_back(session.image());
  }
  return moments_of(std::move(images));
}

Moments moments_of(std::vector<Image> images) {
  Moments m{images.front().width, images.front().height, static_cast<int>(images.size()), {}, {}, {}};
  for (size_t p = 0; p < images.front().pixels.size(); ++p) {
    glm::dvec3 sum(0);
    for (const Image& image : images) sum += glm::dvec3(image.pixels[p]);
    const glm::dvec3 mean = sum / static_cast<double>(m.count);
    glm::dvec3 squares(0);
    for (const Image& image : images)
      squares += (glm::dvec3(image.pixels[p]) - mean) * (glm::dvec3(image.pixels[p]) - mean);
    m.mean.emplace_back(mean);
    m.variance.emplace_back(squares / static_cast<double>(m.count - 1));
  }
  m.images = std::move(images);
  return m;
}

}  // namespace relume::support
