#include "techniques/denoise/shared/testing/denoiser_bench.h"

namespace relume {
namespace {

void bm_edge_emission(benchmark::State& state) { testing::bench_denoiser(state, DenoiseChoice::svgf, "edges"); }
BENCHMARK(bm_edge_emission)->Unit(benchmark::kMillisecond)->UseManualTime();

void bm_split_light(benchmark::State& state) { testing::bench_denoiser(state, DenoiseChoice::svgf, "split"); }
BENCHMARK(bm_split_light)->Unit(benchmark::kMillisecond)->UseManualTime();

}  // namespace
}  // namespace relume
