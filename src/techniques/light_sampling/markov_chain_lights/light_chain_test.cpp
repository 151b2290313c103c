// The probabilities of lights for fixed tables of states, also of bits that no chain would write.
#include "techniques/light_sampling/markov_chain_lights/light_chain.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "scene/testing/light_scene.h"
#include "techniques/light_sampling/light_tree/build_light_tree.h"
#include "techniques/spatial/markov_grid/testing/filled_table.h"
#include "testing/chi2.h"
#include "testing/random.h"

namespace relume {
namespace {

enum class States : int { plausible, equal, garbage, vanished };
constexpr States kAllStates[] = {States::plausible, States::equal, States::garbage, States::vanished};

/// State of a cell among `lights` lights.
LightState state_of(States states, uint32_t number, uint32_t lights) {
  testing::Random random(number);
  switch (states) {
    case States::plausible: return {random.next_bits() % lights, 0.01f + random.next(), 3};
    case States::equal: return {0, 1, 1};
    case States::vanished: return {lights + random.next_bits() % 3, 1, 1};
    case States::garbage: break;
  }
  constexpr uint32_t kWeights[] = {0x7fc00000u, 0x7f800000u, 0xff800000u, 0xbf800000u, 0x7f7fffffu, 1u, 0x3f000000u};
  return {random.next() < 0.5f ? random.next_bits() : random.next_bits() % lights,
          bits_float(kWeights[random.next_bits() % 7]), random.next_bits()};
}

/// Points in several places, with one- and two-sided reflection.
std::vector<SurfacePoint> receivers() {
  std::vector<SurfacePoint> points;
  for (const Vec3& position : {Vec3(0), Vec3(-1, 1.2f, 0.2f), Vec3(0.5f, 0.3f, 0)}) {
    SurfacePoint sp = testing::point_at(position, glm::normalize(Vec3(0.1f, 1, 0.2f)));
    sp.wo_local = Vec3(0, 0, 1);
    make_bsdf(sp.bsdf, MaterialSample{}, MaterialData{}, energy_tables(), 1, true);
    points.push_back(sp);
  }
  return points;
}

void check(const MarkovChainLights& chains, const LightTree& tree, const SurfacePoint& sp, uint32_t light_count,
           const std::string& name) {
  double sum = 0;
  for (LightId i = 0; i < light_count; ++i) {
    ASSERT_GE(chains.pmf(tree, sp, i), 0.0f) << name;
    sum += double{chains.pmf(tree, sp, i)};
  }
  ASSERT_NEAR(sum, 1.0, 1e-5) << name;
  constexpr int kSamples = 50000;
  std::vector<uint64_t> counts(light_count, 0);
  std::vector<uint64_t> rest(32, 0);
  testing::Random random(71);
  for (int i = 0; i < kSamples; ++i) {
    const float u = random.next();
    const LightSelection s = chains.sample(tree, sp, u, random.next_bits());
    ASSERT_LT(s.light, light_count) << name;
    ASSERT_FLOAT_EQ(s.pmf, chains.pmf(tree, sp, s.light)) << name;
    ASSERT_TRUE(s.u >= 0.0f && s.u < 1.0f) << name;
    ++counts[s.light];
    ++rest[static_cast<size_t>(s.u * 32)];
  }
  std::vector<double> expected;
  for (LightId i = 0; i < light_count; ++i) expected.push_back(double{chains.pmf(tree, sp, i)} * kSamples);
  EXPECT_GT(testing::chi2_test(counts, expected).p_value, testing::significance()) << name;
  EXPECT_GT(testing::chi2_test(rest, std::vector<double>(32, kSamples / 32.0)).p_value, testing::significance())
      << name;
}

TEST(LightChains, ProbabilitiesSumToOneAndSamplesFollowThem) {
  for (const Environment& environment : {Environment{}, testing::noise_environment(24, 12)}) {
    const testing::LightScene scene = testing::make_light_scene(environment);
    const LightsView& lights = scene.lights();
    const LightTreeData data = build_light_tree(lights);
    const LightTree tree = data.view(lights);
    for (const States states : kAllStates) {
      for (const SurfacePoint& sp : receivers()) {
        testing::FilledTable<LightState> table;
        table.fill(sp, [&](uint32_t number) { return state_of(states, number, lights.lights.size); });
        const MarkovChainLights chains{table.grid, table.view(), 0.2f};
        check(chains, tree, sp, lights.lights.size, "states " + std::to_string(static_cast<int>(states)));
      }
    }
  }
}

TEST(LightChains, MixTheLightsOfTheDrawnCellsWithTheTree) {
  const testing::LightScene scene = testing::make_light_scene({});
  const LightTreeData data = build_light_tree(scene.lights());
  const LightTree tree = data.view(scene.lights());
  const SurfacePoint sp = receivers().front();
  testing::FilledTable<LightState> table;
  table.fill(sp, [](uint32_t) { return LightState{1, 2, 1}; });
  const MarkovChainLights chains{table.grid, table.view(), 0.2f};
  EXPECT_NEAR(chains.pmf(tree, sp, 1), 0.8f + 0.2f * tree.pmf(sp, 1), 1e-6f);
  EXPECT_NEAR(chains.pmf(tree, sp, 0), 0.2f * tree.pmf(sp, 0), 1e-6f);
}

TEST(LightChains, EqualTheTreeWithoutUsableStates) {
  const testing::LightScene scene = testing::make_light_scene({});
  const LightTreeData data = build_light_tree(scene.lights());
  const LightTree tree = data.view(scene.lights());
  const SurfacePoint sp = receivers().front();
  testing::FilledTable<LightState> table;
  table.fill(sp, [&](uint32_t) { return LightState{scene.lights().lights.size, 1, 1}; });
  const MarkovChainLights chains{table.grid, table.view(), 0.2f};
  testing::Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const ReusableNumber n{random.next(), random.next_bits()};
    const LightSelection a = chains.sample(tree, sp, n.u, n.bits);
    const LightSelection b = tree.sample(sp, n);
    ASSERT_EQ(a.light, b.light);
    ASSERT_EQ(a.pmf, b.pmf);
    ASSERT_EQ(a.u, b.u);
  }
}

}  // namespace
}  // namespace relume
