// The density of guided directions for fixed tables of states, also of bits that no chain would write.
#include "techniques/guiding/markov_chain/markov_guide.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "materials/testing/bsdf_charts.h"
#include "techniques/guiding/direction_sampling/direction_sampler.h"
#include "techniques/guiding/markov_chain/testing/random_states.h"
#include "techniques/spatial/markov_grid/testing/filled_table.h"
#include "testing/histogram.h"

namespace relume {
namespace {

enum class States : int { plausible, garbage, narrow };
constexpr States kAllStates[] = {States::plausible, States::garbage, States::narrow};

/// A table of states around points.
struct Table {
  testing::FilledTable<GuideState> table;

  MarkovGuide guide() const { return {.grid = table.grid, .table = table.view()}; }
  DirectionSampler sampler(float bsdf_fraction) const {
    DirectionSampler directions;
    directions.kind = DirectionSamplerKind::markov_chains;
    directions.chains = guide();
    directions.chains.bsdf_fraction = bsdf_fraction;
    return directions;
  }
  void fill(const SurfacePoint& sp, States states) {
    // Narrow lobes towards one side mislead.
    const Vec3 side = sp.position + sp.frame.to_world(glm::normalize(Vec3(0.9f, 0.1f, 0.3f)));
    table.fill(sp, [&](uint32_t number) {
      switch (states) {
        case States::plausible: return testing::random_state(number);
        case States::garbage: return testing::garbage_state(number);
        case States::narrow: break;
      }
      return testing::narrow_state(side);
    });
  }
};

MarkovLobes lobes_at(const SurfacePoint& sp, const MarkovGuide& guide) {
  MarkovLobes lobes;
  guide.add_lobes(sp, lobes);
  return lobes;
}

SurfacePoint make_point(const testing::BsdfCase& c) {
  SurfacePoint sp = testing::point_at({0.4f, -0.2f, 0.7f}, glm::normalize(Vec3(0.3f, 0.9f, -0.2f)));
  sp.wo_local = glm::normalize(Vec3(0.4f, -0.3f, 0.6f));
  sp.bsdf = c.make(sp.wo_local.z, true);
  return sp;
}

/// Reflecting and transmitting materials, some with a delta lobe.
std::vector<testing::BsdfCase> materials() {
  std::vector<testing::BsdfCase> cases;
  for (const testing::BsdfCase& c : testing::material_cases({0.0f, 0.3f})) {
    if (!c.name.ends_with(testing::to_string(MicrofacetModel::beckmann))) cases.push_back(c);
  }
  return cases;
}

Sampler numbers(uint32_t i) { return Sampler::sequence(11, i, 0, 0, 0); }

TEST(MarkovGuide, DensitiesOfLobesIntegrateToOne) {
  const SurfacePoint sp = make_point(materials().front());
  const testing::DirectionChart chart{sp.frame, 1.0};
  for (uint32_t seed = 0; seed < 4; ++seed) {
    Table t;
    t.table.grid.seed = seed;
    t.fill(sp, States::plausible);
    const MarkovLobes lobes = lobes_at(sp, t.guide());
    ASSERT_FALSE(lobes.empty());
    const auto pdf = [&](const Vec3& w) { return static_cast<double>(lobes.pdf(w)); };
    EXPECT_NEAR(testing::integrate_square(chart.density(pdf), 32, 1e-4, 5), 1.0, 1e-3) << seed;
  }
}

TEST(MarkovGuide, SamplesOfLobesFollowTheirDensity) {
  constexpr uint32_t kSamples = 100000;
  const SurfacePoint sp = make_point(materials().front());
  const testing::DirectionChart chart{sp.frame, 1.0};
  for (uint32_t seed = 0; seed < 3; ++seed) {
    Table t;
    t.table.grid.seed = seed;
    t.fill(sp, States::plausible);
    const MarkovLobes lobes = lobes_at(sp, t.guide());
    testing::Histogram histogram(16);
    testing::Random random(seed);
    for (uint32_t i = 0; i < kSamples; ++i) {
      const Vec2 p = chart.coordinates(lobes.sample(random.next_2d()));
      histogram.add(static_cast<double>(p.x), static_cast<double>(p.y));
    }
    const auto pdf = [&](const Vec3& w) { return static_cast<double>(lobes.pdf(w)); };
    EXPECT_GT(histogram.test(chart.density(pdf), 6, 2).p_value, testing::significance()) << seed;
  }
}

TEST(MarkovGuide, SamplesFollowTheDensityOfTheMixtureWithTheBsdf) {
  // A bin has 139 samples on average. Integrating the density takes most of the time, which grows with the bins.
  constexpr uint32_t kSamples = 20000;
  constexpr int kBins = 12;
  constexpr double kMaxStrays = 5e-4;  // the horizon cuts bins, of which quadrature misses small parts
  for (const testing::BsdfCase& c : materials()) {
    const SurfacePoint sp = make_point(c);
    Table t;
    t.fill(sp, States::plausible);
    const DirectionSampler directions = t.sampler(0.3f);
    const testing::PeakDirections peaks = testing::peak_directions(c, sp.wo_local);
    const testing::DirectionChart chart{make_frame(sp.frame.to_world(peaks.above)), clamp(double{c.alpha}, 0.02, 0.5)};
    testing::Histogram histogram(kBins);
    for (uint32_t i = 0; i < kSamples; ++i) {
      Sampler u = numbers(i);
      const BsdfSample s = directions.sample(sp, u);
      if (!s.valid || s.delta) {
        histogram.add_outside();
        continue;
      }
      const Vec2 p = chart.coordinates(s.wi);
      histogram.add(static_cast<double>(p.x), static_cast<double>(p.y));
    }
    const auto pdf = [&](const Vec3& w) {
      const BsdfEval e = eval_pdf(sp, w);
      return is_black(e.f) || e.pdf_forward <= 0.0f ? 0.0 : double{directions.pdf(sp, w, e)};
    };
    const auto expected = testing::Histogram::integrals(chart.density(pdf), kBins, 0.1 / kSamples, 6, 2);
    EXPECT_GT(histogram.test_against(expected, kMaxStrays).p_value, testing::significance()) << c.name;
  }
}

TEST(MarkovGuide, SamplesCarryTheDensityThatLightSamplesAreWeightedWith) {
  int compared = 0;
  for (const testing::BsdfCase& c : materials()) {
    const SurfacePoint sp = make_point(c);
    for (const States states : kAllStates) {
      Table t;
      t.fill(sp, states);
      const DirectionSampler directions = t.sampler(0.15f);
      for (uint32_t i = 0; i < 500; ++i) {
        Sampler u = numbers(i);
        const BsdfSample s = directions.sample(sp, u);
        if (!s.valid || s.delta) continue;
        ASSERT_TRUE(is_finite(s.pdf_w) && s.pdf_w > 0.0f && is_finite(s.weight)) << c.name;
        const BsdfEval e = eval_pdf(sp, s.wi);
        // Sampling and evaluating a BSDF round differently, and narrow lobes leave most densities to the BSDF.
        ASSERT_NEAR(s.pdf_w / directions.pdf(sp, s.wi, e), 1.0f, 1e-2f) << c.name;
        const Rgb expected = e.f * (shading_cosine(sp, s.wi) / s.pdf_w);
        for (int k = 0; k < 3; ++k) ASSERT_NEAR(s.weight[k], expected[k], 2e-2f * expected[k] + 1e-6f) << c.name;
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 1000);
}

/// Mean of weight × h over samples, and its variance.
struct Estimate {
  double mean = 0;
  double variance = 0;
};

constexpr size_t kFunctions = 3;

std::array<double, kFunctions> functions_of(const Vec3& w) {
  return {1.0, w.x < 0.1f ? 1.0 : 0.0, std::exp(double{3.0f * w.y})};
}

template <typename SamplerOf>
std::array<Estimate, kFunctions> estimates(const SurfacePoint& sp, uint32_t samples, uint32_t first,
                                           const SamplerOf& sampler_of) {
  std::array<Estimate, kFunctions> result{};
  for (uint32_t i = 0; i < samples; ++i) {
    Sampler u = numbers(first + i);
    const BsdfSample s = sampler_of(i).sample(sp, u);
    if (!s.valid) continue;
    const auto h = functions_of(s.wi);
    for (size_t k = 0; k < kFunctions; ++k) {
      const double x = double{luminance(s.weight)} * h[k];
      result[k].mean += x / samples;
      result[k].variance += x * x / samples;
    }
  }
  for (Estimate& e : result) e.variance = std::max(e.variance - e.mean * e.mean, 0.0);  // not negative by rounding
  return result;
}

TEST(MarkovGuide, AnyStatesKeepTheMean) {
  constexpr uint32_t kSamples = 20000;
  constexpr uint32_t kPerFrame = 100;
  for (const testing::BsdfCase& c : materials()) {
    const SurfacePoint sp = make_point(c);
    const DirectionSampler bsdf;
    const auto expected = estimates(sp, kSamples, kSamples, [&](uint32_t) -> const DirectionSampler& { return bsdf; });
    for (const States states : kAllStates) {
      Table t;
      DirectionSampler directions;
      const auto of_frame = [&](uint32_t i) -> const DirectionSampler& {
        if (i % kPerFrame == 0) {  // other cells
          t.table.grid.seed = i;
          t.fill(sp, states);
          directions = t.sampler(0.3f);
        }
        return directions;
      };
      const auto found = estimates(sp, kSamples, 0, of_frame);
      for (size_t k = 0; k < kFunctions; ++k) {
        const double error = std::sqrt((found[k].variance + expected[k].variance) / kSamples);
        EXPECT_NEAR(found[k].mean, expected[k].mean, 5 * error + 1e-9)
            << c.name << ' ' << static_cast<int>(states) << ' ' << k;
      }
    }
  }
}

TEST(MarkovGuide, EqualsTheBsdfWithoutStates) {
  const Table t;
  const DirectionSampler directions = t.sampler(0.15f);
  for (const testing::BsdfCase& c : materials()) {
    const SurfacePoint sp = make_point(c);
    for (uint32_t i = 0; i < 50; ++i) {
      Sampler a = numbers(i);
      Sampler b = numbers(i);
      const BsdfSample guided = directions.sample(sp, a);
      const BsdfSample plain = DirectionSampler{}.sample(sp, b);
      ASSERT_EQ(guided.wi, plain.wi);
      ASSERT_EQ(guided.pdf_w, plain.pdf_w);
      ASSERT_EQ(directions.pdf(sp, plain.wi, eval_pdf(sp, plain.wi)), eval_pdf(sp, plain.wi).pdf_forward);
    }
  }
}

TEST(MarkovGuide, StaticCellsOfferNoLobesBelowTheHorizon) {
  Table t;
  t.table.grid.adaptive_share = 0;
  for (const testing::BsdfCase& c : materials()) {
    const SurfacePoint sp = make_point(c);
    bool transmits = false;
    for (int i = 0; i < sp.bsdf.lobe_count; ++i) transmits |= is_rough_transmission(sp.bsdf.lobes[i].kind);
    t.table.fill(sp, [&](uint32_t) { return testing::narrow_state(sp.position - sp.frame.n); });
    EXPECT_EQ(lobes_at(sp, t.guide()).empty(), !transmits) << c.name;
    t.table.fill(sp, [&](uint32_t) { return testing::narrow_state(sp.position + sp.frame.n); });
    EXPECT_FALSE(lobes_at(sp, t.guide()).empty()) << c.name;
  }
}

}  // namespace
}  // namespace relume
