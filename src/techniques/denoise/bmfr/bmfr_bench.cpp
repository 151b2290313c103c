#include <benchmark/benchmark.h>

#include <cmath>
#include <vector>

#include "techniques/denoise/bmfr/bmfr.h"
#include "techniques/denoise/bmfr/regression_kernel.h"
#include "techniques/denoise/shared/testing/denoiser_bench.h"

namespace relume {
namespace {

constexpr uint32_t kWidth = 1280;
constexpr uint32_t kHeight = 720;

/// The regression of one image of 1280 × 720 pixels on one or two threads.
void bm_bmfr_regression(benchmark::State& state) {
  const size_t pixels = kWidth * kHeight;
  std::vector<Vec3> position(pixels);
  std::vector<Vec3> normal(pixels);
  std::vector<Rgb> light(pixels);
  std::vector<float> square(pixels);
  for (uint32_t i = 0; i < pixels; ++i) {
    const float x = static_cast<float>(i % kWidth) * 0.01f;
    const float y = static_cast<float>(i / kWidth) * 0.01f;
    position[i] = Vec3(x, y, std::sin(x) + std::cos(y));
    normal[i] = glm::normalize(Vec3(std::cos(x), std::sin(y), 1.0f));
    light[i] = Rgb(1.0f + 0.5f * normal[i].x, 1, 0.5f);
    square[i] = sqr(luminance(light[i]));
  }
  const std::vector<Rgb> albedo(pixels, Rgb(0.5f));
  const std::vector<uint32_t> samples(pixels, 4);
  std::vector<Rgb> fitted(pixels);
  std::vector<float> noise(kBlockNoise);
  BlockRegressionKernel kernel;
  kernel.position = view_of(position);
  kernel.normal = view_of(normal);
  kernel.albedo = view_of(albedo);
  kernel.light = view_of(light);
  kernel.samples = view_of(samples);
  kernel.square = view_of(square);
  kernel.noise = view_of(noise);
  kernel.fitted = mutable_view_of(fitted);
  kernel.noise_scale = 0.01f;
  kernel.width = kWidth;
  kernel.height = kHeight;
  Backend backend(static_cast<int>(state.range(0)));
  launch(backend, "noise", BlockNoiseKernel{mutable_view_of(noise), 1}, kBlockPixels, kBlockFeatures - 1);
  for (auto _ : state)
    launch(backend, "fit", kernel, BlockRegressionKernel::blocks(kWidth), BlockRegressionKernel::blocks(kHeight), {},
           1);
  if (std::fabs(fitted[pixels / 2].g - 1.0f) > 1e-3f) state.SkipWithError("the fit is not what it should be");
  state.SetItemsProcessed(state.iterations() * static_cast<int64_t>(pixels));
}
BENCHMARK(bm_bmfr_regression)->Arg(1)->Arg(2)->Unit(benchmark::kMillisecond)->UseRealTime();

void bm_bmfr(benchmark::State& state) { testing::bench_denoiser(state, DenoiseChoice::bmfr, "bmfr"); }
BENCHMARK(bm_bmfr)->Unit(benchmark::kMillisecond)->UseManualTime();

}  // namespace
}  // namespace relume
