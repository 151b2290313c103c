#include <benchmark/benchmark.h>

#include "materials/testing/bsdf_cases.h"

namespace relume {
namespace {

using testing::MaterialCase;

/// Common materials, by index.
MaterialCase common_material(int64_t i) {
  const char* names[] = {"diffuse", "plastic", "metal", "glass", "thin wall", "coated plastic"};
  for (const MaterialCase& m : testing::material_list()) {
    if (m.name == names[i]) return m;
  }
  return {};
}
constexpr int kCommonMaterials = 6;

Vec2 some_point(uint32_t& i) {
  i = i * 1664525u + 1013904223u;
  return {to_unit_float(i), to_unit_float(i << 8)};
}

void bm_make_bsdf(benchmark::State& state) {
  const MaterialCase m = common_material(state.range(0));
  MaterialSample parameters = m.sample;
  parameters.roughness = 0.4f;
  MaterialData data;
  data.volume = m.volume;
  const EnergyTables& tables = energy_tables();
  Bsdf bsdf{};
  for (auto _ : state) {
    benchmark::DoNotOptimize(parameters);
    make_bsdf(bsdf, parameters, data, tables, 0.7f, true);
    benchmark::DoNotOptimize(bsdf);
  }
  state.SetLabel(m.name);
}
BENCHMARK(bm_make_bsdf)->DenseRange(0, kCommonMaterials - 1);

void bm_eval_pdf(benchmark::State& state) {
  const MaterialCase m = common_material(state.range(0));
  const Bsdf bsdf = testing::full_material(m, 0.4f, MicrofacetModel::ggx).make(0.7f, true);
  const Vec3 wo = testing::viewer(0.7f);
  uint32_t i = 1;
  for (auto _ : state) benchmark::DoNotOptimize(eval_pdf(bsdf, wo, cosine_hemisphere_from_square(some_point(i))));
  state.SetLabel(m.name);
}
BENCHMARK(bm_eval_pdf)->DenseRange(0, kCommonMaterials - 1);

void bm_sample_bsdf(benchmark::State& state) {
  const MaterialCase m = common_material(state.range(0));
  const Bsdf bsdf = testing::full_material(m, 0.4f, MicrofacetModel::ggx).make(0.7f, true);
  const Vec3 wo = testing::viewer(0.7f);
  uint32_t i = 1;
  for (auto _ : state) {
    const Vec2 u = some_point(i);
    benchmark::DoNotOptimize(sample(bsdf, wo, to_unit_float(hash(i)), u));
  }
  state.SetLabel(m.name);
}
BENCHMARK(bm_sample_bsdf)->DenseRange(0, kCommonMaterials - 1);

}  // namespace
}  // namespace relume
