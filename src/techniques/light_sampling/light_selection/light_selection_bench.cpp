#include <benchmark/benchmark.h>

#include <vector>

#include "core/hash.h"
#include "lights/testing/lamps.h"
#include "materials/make_bsdf.h"
#include "techniques/light_sampling/light_selection/weighed_lights.h"

namespace relume {
namespace {

constexpr uint32_t kLamps = 1000;

/// The weighing of a bucket that lists and caches do per sample.
void bm_weigh_lights(benchmark::State& state) {
  const std::vector<Light> lamps = testing::make_lamps(kLamps, 30);
  LightsView lights;
  lights.lights = view_of(lamps);
  lights.first_infinite = kLamps;
  const std::vector<CompactLight> compact = compact_lights(lights);
  SurfacePoint sp{};
  sp.position = Vec3(15, 0, 15);
  sp.frame = make_frame(Vec3(0, 1, 0));
  sp.wo_local = Vec3(0, 0, 1);
  make_bsdf(sp.bsdf, MaterialSample{}, MaterialData{}, energy_tables(), 1, true);
  const View<const CompactLight> view = view_of(compact);
  const LtcTable ltc = ltc_table();
  const uint32_t count = static_cast<uint32_t>(state.range(0));
  const auto id_at = [](uint32_t i) { return hash(i) % kLamps; };
  const LightCandidates<decltype(id_at)> candidates{ltc, lights, view, count, id_at};
  for (auto _ : state) {
    const WeighedLights weighed(candidates, sp);
    benchmark::DoNotOptimize(weighed.sum);
  }
}
BENCHMARK(bm_weigh_lights)->ArgName("lights")->Arg(8)->Arg(kMaxWeighedLights);

}  // namespace
}  // namespace relume
