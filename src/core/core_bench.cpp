#include <benchmark/benchmark.h>

#include "core/frame.h"
#include "core/hash.h"
#include "core/octahedral.h"

namespace relume {
namespace {

Vec3 some_direction(uint32_t i) {
  return glm::normalize(Vec3(to_unit_float(hash(i, 0u)), to_unit_float(hash(i, 1u)), to_unit_float(hash(i, 2u))) -
                        0.5f);
}

void bm_hash(benchmark::State& state) {
  uint32_t x = 1;
  for (auto _ : state) benchmark::DoNotOptimize(x = hash(x, 2u, 3u, 4u));
}
BENCHMARK(bm_hash);

void bm_make_frame(benchmark::State& state) {
  Vec3 n = some_direction(1);
  for (auto _ : state) {
    benchmark::DoNotOptimize(n);
    benchmark::DoNotOptimize(make_frame(n));
  }
}
BENCHMARK(bm_make_frame);

void bm_pack_and_unpack_direction(benchmark::State& state) {
  Vec3 d = some_direction(2);
  if (glm::dot(unpack_direction(pack_direction(d)), d) < 0.999999f) state.SkipWithError("wrong direction");
  for (auto _ : state) {
    benchmark::DoNotOptimize(d);
    benchmark::DoNotOptimize(unpack_direction(pack_direction(d)));
  }
}
BENCHMARK(bm_pack_and_unpack_direction);

}  // namespace
}  // namespace relume
