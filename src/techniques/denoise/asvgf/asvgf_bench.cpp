#include "techniques/denoise/shared/testing/denoiser_bench.h"

namespace relume {
namespace {

void bm_asvgf_still(benchmark::State& state) { testing::bench_denoiser(state, DenoiseChoice::asvgf, "asvgf"); }
BENCHMARK(bm_asvgf_still)->Unit(benchmark::kMillisecond)->UseManualTime();

}  // namespace
}  // namespace relume
