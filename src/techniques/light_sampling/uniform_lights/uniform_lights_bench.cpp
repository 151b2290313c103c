#include <benchmark/benchmark.h>

#include "core/hash.h"
#include "techniques/light_sampling/uniform_lights/uniform_lights.h"

namespace relume {
namespace {

void bm_uniform_lights(benchmark::State& state) {
  const UniformLights lights{1000};
  uint32_t i = 1;
  for (auto _ : state) {
    i = i * 1664525u + 1013904223u;
    benchmark::DoNotOptimize(lights.sample({to_unit_float(i), i}));
  }
}
BENCHMARK(bm_uniform_lights);

}  // namespace
}  // namespace relume
