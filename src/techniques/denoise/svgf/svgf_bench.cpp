#include "techniques/denoise/shared/testing/denoiser_bench.h"

namespace relume {
namespace {

void bm_svgf(benchmark::State& state) { testing::bench_denoiser(state, DenoiseChoice::svgf, "svgf"); }
BENCHMARK(bm_svgf)->Unit(benchmark::kMillisecond)->UseManualTime();

}  // namespace
}  // namespace relume
