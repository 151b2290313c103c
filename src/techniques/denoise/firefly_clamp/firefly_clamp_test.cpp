#include "techniques/denoise/firefly_clamp/firefly_clamp.h"

#include <gtest/gtest.h>

#include <iostream>
#include <limits>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "render/session.h"
#include "scene/compiled_scene.h"
#include "scene/testing/media.h"

namespace relume {
namespace {

constexpr uint32_t kSize = 9;
constexpr uint32_t kMiddle = kSize * kSize / 2;

struct Neighbourhood {
  explicit Neighbourhood(const Material& material)
      : scene(testing::plate(material, 5, 1e-3f), {.camera = {}, .width = kSize, .height = kSize}) {
    for (Hit& hit : hits) hit.instance = 0;
  }

  std::vector<float> factors(float limit) {
    std::vector<float> result(kSize * kSize);
    const FireflyFactorKernel kernel{
        scene.view(), view_of(hits), view_of(radiance), view_of(allocation), mutable_view_of(result), limit,
        kSize,        kSize};
    for (uint32_t i = 0; i < kSize * kSize; ++i) kernel(i % kSize, i / kSize);
    return result;
  }

  CompiledScene scene;
  std::vector<Hit> hits = std::vector<Hit>(kSize * kSize);
  std::vector<Rgb> radiance = std::vector<Rgb>(kSize * kSize, Rgb(1));
  std::vector<uint32_t> allocation;
};

TEST(FireflyClamp, ClampsToAMultipleOfTheNeighboursMean) {
  Neighbourhood n(testing::matte(Rgb(0.5f)));
  n.radiance[kMiddle] = Rgb(32);
  const std::vector<float> factors = n.factors(4);
  for (uint32_t i = 0; i < kSize * kSize; ++i) EXPECT_FLOAT_EQ(factors[i], i == kMiddle ? 4.0f / 32 : 1.0f) << i;
}

TEST(FireflyClamp, KeepsSmallerDeviations) {
  Neighbourhood n(testing::matte(Rgb(0.5f)));
  for (uint32_t i = 0; i < kSize * kSize; ++i) n.radiance[i] = Rgb(i % 2 ? 0.0f : 3.0f);
  EXPECT_EQ(n.factors(4), std::vector<float>(kSize * kSize, 1.0f));
}

TEST(FireflyClamp, KeepsEmittersAndTheBackground) {
  Material lamp = testing::matte(Rgb(0));
  lamp.emission = Rgb(32);
  Neighbourhood emits(lamp);
  emits.radiance[kMiddle] = Rgb(32);
  EXPECT_EQ(emits.factors(4)[kMiddle], 1.0f);
  Neighbourhood open(testing::matte(Rgb(0.5f)));
  open.radiance[kMiddle] = Rgb(32);
  open.hits[kMiddle] = Hit{};
  EXPECT_EQ(open.factors(4)[kMiddle], 1.0f);
}

TEST(FireflyClamp, ComparesOnlyWithSamplesOfThisFrame) {
  Neighbourhood n(testing::matte(Rgb(0.5f)));
  n.radiance[kMiddle] = Rgb(32);
  n.radiance[kMiddle + 1] = Rgb(std::numeric_limits<float>::quiet_NaN());
  n.allocation.assign(kSize * kSize, 1);
  n.radiance[kMiddle - 1] = Rgb(1e6f);
  n.allocation[kMiddle - 1] = 0;
  const std::vector<float> factors = n.factors(4);
  EXPECT_FLOAT_EQ(factors[kMiddle], 4.0f / 32);
  EXPECT_EQ(factors[kMiddle - 1], 1.0f) << "an old sample was scaled";
  EXPECT_EQ(factors[kMiddle + 1], 1.0f);
}

TEST(FireflyClamp, KeepsSamplesWithoutNeighbours) {
  Neighbourhood n(testing::matte(Rgb(0.5f)));
  n.radiance.assign(kSize * kSize, Rgb(0));
  n.radiance[kMiddle] = Rgb(32);
  EXPECT_EQ(n.factors(4)[kMiddle], 1.0f) << "among black ones";
  n.allocation.assign(kSize * kSize, 0);
  n.allocation[kMiddle] = 1;
  EXPECT_EQ(n.factors(4)[kMiddle], 1.0f);
}

struct Rendered {
  double mean = 0;      ///< luminance
  double variance = 0;  ///< variance of a pixel's luminance between frames, mean over the pixels
  std::vector<Rgb> pixels;
};

/// Renders frames of one sample per pixel.
Rendered render(const Scene& scene, float limit, int frames, DenoiseChoice denoise = DenoiseChoice::none) {
  RenderSettings settings;
  settings.width = 64;
  settings.height = 48;
  settings.threads = 1;
  settings.history = HistoryChoice::none;
  settings.denoise = denoise;
  settings.firefly.limit = limit;
  Session session(scene, settings);
  std::vector<double> sum(64 * 48);
  std::vector<double> squares(64 * 48);
  Rendered result;
  for (int frame = 0; frame < frames; ++frame) {
    session.render_frame();
    result.pixels = session.image().pixels;
    for (size_t i = 0; i < sum.size(); ++i) {
      const double value = luminance(result.pixels[i]);
      sum[i] += value / frames;
      squares[i] += value * value / frames;
    }
  }
  for (size_t i = 0; i < sum.size(); ++i) {
    result.mean += sum[i] / static_cast<double>(sum.size());
    result.variance += (squares[i] - sum[i] * sum[i]) / static_cast<double>(sum.size());
  }
  return result;
}

// Rare bright paths carry a sixth of the light in this scene.
TEST(FireflyClamp, CutsMoreVarianceThanEnergy) {
  const Scene gallery = find_builtin_scene("mine")->build();
  const Rendered all = render(gallery, 0, 64);
  const Rendered clamped = render(gallery, 8, 64);
  std::cerr << "mean " << all.mean << ", clamped " << clamped.mean << "; variance " << all.variance << ", clamped "
            << clamped.variance << "\n";
  EXPECT_LT(clamped.variance, 0.5 * all.variance);
  EXPECT_LT(clamped.mean, all.mean);
  EXPECT_GT(clamped.mean, 0.8 * all.mean);
}

TEST(FireflyClamp, IsBitExactWithoutFireflies) {
  constexpr int kFrames = 8;
  const Scene box = find_builtin_scene("cornell")->build();
  for (const DenoiseChoice denoise : {DenoiseChoice::none, DenoiseChoice::svgf})
    EXPECT_EQ(render(box, 0, kFrames, denoise).pixels, render(box, 1e6f, kFrames, denoise).pixels);
}

}  // namespace
}  // namespace relume
