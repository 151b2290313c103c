#include <benchmark/benchmark.h>

#include <vector>

#include "techniques/guiding/direction_sampling/direction_sampler.h"

namespace relume {
namespace {

void bm_sample_direction(benchmark::State& state) {
  std::vector<uint32_t> words(4);
  DirectionSampler directions;
  directions.kind = static_cast<DirectionSamplerKind>(state.range(0));
  directions.quadtrees = {mutable_view_of(words), 128};
  directions.quadtrees.store(0, uniform_quadtree(128));
  SurfacePoint sp{};
  sp.frame = make_frame(Vec3(0, 1, 0));
  sp.ng = sp.frame.n;
  sp.wo_local = Vec3(0, 0, 1);
  sp.region = 0;
  make_bsdf(sp.bsdf, MaterialSample{}, MaterialData{}, energy_tables(), 1, true);
  uint32_t i = 0;
  for (auto _ : state) {
    Sampler numbers = Sampler::sequence(1, 0, 0, i++);
    benchmark::DoNotOptimize(directions.sample(sp, numbers));
  }
}
BENCHMARK(bm_sample_direction)->ArgName("guided")->Arg(0)->Arg(1);

}  // namespace
}  // namespace relume
