#include <benchmark/benchmark.h>

#include <vector>

#include "techniques/denoise/oidn/oidn_filter.h"

namespace relume {
namespace {

/// The library on an image of 640 × 360 pixels, if available.
void bm_oidn(benchmark::State& state) {
  constexpr uint32_t kWidth = 640;
  constexpr uint32_t kHeight = 360;
  const std::vector<Rgb> color(kWidth * kHeight, Rgb(0.5f));
  const std::vector<Vec3> normal(color.size(), Vec3(0, 0, 1));
  std::vector<Rgb> output(color.size());
  const bool missing = !oidn_missing().empty();
  if (missing) state.SetLabel("the library is not installed");
  for (auto _ : state) {
    if (!missing) oidn_filter({color.data(), color.data(), normal.data(), output.data(), kWidth, kHeight}, 2);
  }
}
BENCHMARK(bm_oidn)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace relume
