// The contract of direction samplers: samples follow the density of the mixture, weights are f cos θ / pdf_w, and
// delta lobes keep their weight.
#include "techniques/guiding/direction_sampling/direction_sampler.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "techniques/guiding/direction_sampling/testing/guide.h"

namespace relume {
namespace {

using testing::chart_of;
using testing::Guide;
using testing::histogram_of;
using testing::kBins;
using testing::kMixtureSamples;
using testing::make_point;
using testing::materials;
using testing::numbers;

/// Materials at a roughness. The mixture does not depend on the distribution of normals, which tests of BSDFs vary.
std::vector<testing::BsdfCase> ggx_materials(float roughness) {
  std::vector<testing::BsdfCase> cases = materials({roughness});
  std::erase_if(cases, [](const testing::BsdfCase& c) {
    return c.name.ends_with(testing::to_string(MicrofacetModel::beckmann));
  });
  return cases;
}

void expect_density_of_mixture(const std::vector<testing::BsdfCase>& cases) {
  // Both samplers have one density, integrated once. A fraction other than 0.5 reveals an exchange of BSDF and
  // quadtree.
  constexpr float kBsdfFraction = 0.4f;
  const Guide plain(kBsdfFraction, false);
  const Guide stratified(kBsdfFraction, true);
  // Integrating leaf edges exactly would dominate the run time. An error of a fraction of a sample per part of a bin is
  // far below the noise of its 156 samples.
  constexpr int kDepth = 6;
  constexpr int kLeast = 2;
  constexpr double kTolerance = 0.1 / kMixtureSamples;
  constexpr double kMaxStrays = 5e-4;  // the horizon cuts bins, of which quadrature misses small parts
  for (const testing::BsdfCase& c : cases) {
    const SurfacePoint sp = make_point(c);
    const testing::DirectionChart chart = chart_of(c, sp);
    const auto pdf = [&](const Vec3& w) {
      const BsdfEval e = eval_pdf(sp, w);
      return is_black(e.f) || e.pdf_forward <= 0.0f ? 0.0 : double{plain.sampler.pdf(sp, w, e)};
    };
    const std::vector<double> expected =
        testing::Histogram::integrals(chart.density(pdf), kBins, kTolerance, kDepth, kLeast);
    for (const Guide* guide : {&plain, &stratified}) {
      EXPECT_GT(histogram_of(*guide, sp, chart).test_against(expected, kMaxStrays).p_value, testing::significance())
          << c.name << (guide == &stratified ? ", stratified" : "");
    }
  }
}

/// Narrow lobes: a BSDF with a wide lobe is closer to the quadtree, and tests less. Delta lobes only take their share
/// from the mixture, which DeltaLobesKeepTheirShare tests for all: a third of the materials is enough here.
TEST(DirectionSampler, SamplesFollowTheDensityOfTheMixture) {
  expect_density_of_mixture(ggx_materials(0.3f));
  std::vector<testing::BsdfCase> smooth;
  const std::vector<testing::BsdfCase> all = ggx_materials(0);
  for (size_t i = 0; i < all.size(); i += 3) smooth.push_back(all[i]);
  expect_density_of_mixture(smooth);
}
TEST(SlowDirectionSampler, SamplesFollowTheDensityOfTheMixtureBesideDeltaLobes) {
  expect_density_of_mixture(ggx_materials(0));
}

TEST(DirectionSampler, StratifiedSamplingHasTheSameDensity) {
  const Guide plain(0.4f, false);
  const Guide stratified(0.4f, true);
  int compared = 0;
  for (const testing::BsdfCase& c : materials()) {
    const SurfacePoint sp = make_point(c);
    for (uint32_t i = 0; i < 500; ++i) {
      Sampler u = numbers(i);
      const BsdfSample s = stratified.sampler.sample(sp, u);
      if (!s.valid || s.delta) continue;
      const BsdfEval e = eval_pdf(sp, s.wi);
      const float pdf = plain.sampler.pdf(sp, s.wi, e);
      ASSERT_EQ(stratified.sampler.pdf(sp, s.wi, e), pdf) << c.name;
      ASSERT_NEAR(s.pdf_w / pdf, 1.0f, 2e-3f) << c.name;
      ASSERT_EQ(s.guide_pdf_w, plain.sampler.quadtrees.load(0).pdf(s.wi)) << c.name;
      ++compared;
    }
  }
  EXPECT_GT(compared, 1000);
}

TEST(DirectionSampler, RouletteUsesTheBsdfDensity) {
  const Guide guide(0.3f, false);
  int refracted = 0;
  for (const testing::BsdfCase& c : materials()) {
    const SurfacePoint sp = make_point(c);
    for (uint32_t i = 0; i < 2000; ++i) {
      Sampler u = numbers(i);
      const BsdfSample s = guide.sampler.sample(sp, u);
      if (!s.valid || s.delta || glm::dot(sp.frame.n, s.wi) >= 0.0f || refraction_eta_scale(sp.bsdf) == 1.0f) continue;
      ++refracted;
      const float ratio = s.eta_scale * s.pdf_w / eval_pdf(sp, s.wi).pdf_forward;
      ASSERT_NEAR(ratio, refraction_eta_scale(sp.bsdf), 1e-2f) << c.name;
    }
  }
  EXPECT_GT(refracted, 100);
}

TEST(DirectionSampler, WeightsAreValueTimesCosineOverDensity) {
  const Guide guide(0.3f, false);
  for (const testing::BsdfCase& c : materials()) {
    const SurfacePoint sp = make_point(c);
    for (uint32_t i = 0; i < 1000; ++i) {
      Sampler u = numbers(i);
      const BsdfSample s = guide.sampler.sample(sp, u);
      if (!s.valid || s.delta) continue;
      const BsdfEval e = eval_pdf(sp, s.wi);
      ASSERT_NEAR(s.pdf_w / guide.sampler.pdf(sp, s.wi, e), 1.0f, 2e-3f) << c.name;
      const Rgb expected = e.f * (shading_cosine(sp, s.wi) / s.pdf_w);
      for (int k = 0; k < 3; ++k) ASSERT_NEAR(s.weight[k], expected[k], 5e-3f * expected[k] + 1e-6f) << c.name;
    }
  }
}

TEST(DirectionSampler, DeltaLobesKeepTheirShare) {
  const Guide guide(0.25f, false);
  int with_delta = 0;
  for (const testing::BsdfCase& c : materials()) {
    const SurfacePoint sp = make_point(c);
    const uint32_t samples = has_delta(sp.bsdf) ? 20000 : 1000;  // none may be of a lobe that does not exist
    double sums[2] = {0, 0};
    double squares[2] = {0, 0};
    for (uint32_t i = 0; i < samples; ++i) {
      // Half of the samples are those of light subpaths.
      const TransportMode mode = i % 2 == 0 ? TransportMode::radiance : TransportMode::importance;
      for (const int guided : {0, 1}) {
        Sampler u = numbers(2 * i + static_cast<uint32_t>(guided));
        const BsdfSample s = guided != 0 ? guide.sampler.sample(sp, u, mode) : DirectionSampler{}.sample(sp, u, mode);
        const double weight = s.valid && s.delta ? double{luminance(s.weight)} : 0.0;
        sums[guided] += weight / samples;
        squares[guided] += weight * weight / samples;
      }
    }
    if (sums[0] > 0) ++with_delta;
    const double error = std::sqrt((squares[0] + squares[1]) / samples);
    EXPECT_NEAR(sums[0], sums[1], 5 * error) << c.name;
  }
  EXPECT_GT(with_delta, 0);
}

TEST(DirectionSampler, LearnedFractionsReplaceTheConstantWithoutDeltaLobes) {
  Guide learned(0.5f, false);
  const std::vector<float> fractions{0.3f};
  learned.sampler.fractions = view_of(fractions);
  const Guide expected(0.3f, false);
  const Guide constant(0.5f, false);
  int compared[2] = {0, 0};
  for (const testing::BsdfCase& c : materials()) {
    const SurfacePoint sp = make_point(c);
    const bool delta = has_delta(sp.bsdf);
    const DirectionSampler& same = delta ? constant.sampler : expected.sampler;
    for (uint32_t i = 0; i < 100; ++i) {
      Sampler a = numbers(i);
      Sampler b = numbers(i);
      const BsdfSample s = learned.sampler.sample(sp, a);
      const BsdfSample t = same.sample(sp, b);
      ASSERT_EQ(s.wi, t.wi) << c.name;
      ASSERT_EQ(s.weight, t.weight) << c.name;
      if (!s.valid || s.delta) continue;
      const BsdfEval e = eval_pdf(sp, s.wi);
      ASSERT_EQ(learned.sampler.pdf(sp, s.wi, e), same.pdf(sp, s.wi, e)) << c.name;
      ASSERT_NEAR(s.bsdf_pdf_w / e.pdf_forward, 1.0f, 1e-2f) << c.name;
      ++compared[delta ? 1 : 0];
    }
  }
  EXPECT_GT(compared[0], 100);
  EXPECT_GT(compared[1], 100);
}

/// Mean and variance of weight × h.
struct Estimate {
  double mean = 0;
  double variance = 0;
};

/// Estimates for several functions h of the direction: h(w) returns their values.
template <size_t kCount, typename Functions>
std::array<Estimate, kCount> estimates(const DirectionSampler& sampler, const SurfacePoint& sp, uint32_t samples,
                                       uint32_t first, const Functions& h) {
  std::array<Estimate, kCount> result{};
  for (uint32_t i = 0; i < samples; ++i) {
    Sampler u = numbers(first + i);
    const BsdfSample s = sampler.sample(sp, u);
    if (!s.valid) continue;
    const std::array<double, kCount> values = h(s.wi);
    for (size_t k = 0; k < kCount; ++k) {
      const double x = double{luminance(s.weight)} * values[k];
      result[k].mean += x / samples;
      result[k].variance += x * x / samples;
    }
  }
  for (Estimate& e : result) e.variance -= e.mean * e.mean;
  return result;
}

/// Whether resampling applies to the point.
bool can_resample(const SurfacePoint& sp) { return has_glossy(sp.bsdf) && !has_delta(sp.bsdf); }

TEST(DirectionSampler, ResamplingKeepsTheMean) {
  constexpr uint32_t kSamples = 8000;
  int compared = 0;
  const Guide candidate(0.4f, false);
  for (const testing::BsdfCase& c : materials({0.3f, 0.8f})) {
    if (c.name.ends_with(testing::to_string(MicrofacetModel::beckmann))) continue;
    const SurfacePoint sp = make_point(c);
    if (!can_resample(sp)) continue;
    const Vec3 lamp = sp.frame.to_world(glm::normalize(Vec3(0.2f, 0.5f, 0.6f)));
    // The light of a lamp with its MIS weight, which depends on the density of candidates; a side; everything.
    const auto h = [&](const Vec3& w) {
      const double p = double{candidate.sampler.pdf(sp, w, eval_pdf(sp, w))};
      const double q = glm::dot(w, lamp) > 0.9f ? 5.0 : 0.01;
      return std::array<double, 3>{q * p * p / (p * p + q * q), w.x < 0.1f ? 1.0 : 0.0, 1.0};
    };
    const auto expected = estimates<3>(DirectionSampler{}, sp, kSamples, kSamples, h);
    for (const uint32_t candidates : {2u, 8u}) {
      Guide guide(0.4f, candidates == 8);
      guide.sampler.candidates = candidates;
      const auto found = estimates<3>(guide.sampler, sp, kSamples, 0, h);
      for (size_t k = 0; k < 3; ++k) {
        const double error = std::sqrt((found[k].variance + expected[k].variance) / kSamples);
        EXPECT_NEAR(found[k].mean, expected[k].mean, 5 * error) << c.name << ' ' << candidates << ' ' << k;
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 8);
}

TEST(DirectionSampler, ResamplingFollowsTheProductOfBsdfAndTree) {
  // Light as the tree has learned it. The uniform part of the target keeps some variance: 0.51 were measured with
  // eight.
  int compared = 0;
  for (const testing::BsdfCase& c : materials({0.3f})) {
    const SurfacePoint sp = make_point(c);
    if (!can_resample(sp)) continue;
    Guide guide(0.5f, false);
    const DirectionalQuadtree tree = guide.sampler.quadtrees.load(0);
    const auto light = [&](const Vec3& w) { return std::array<double, 1>{double{tree.pdf(w)}}; };
    const auto variance = [&](uint32_t candidates) {
      guide.sampler.candidates = candidates;
      return estimates<1>(guide.sampler, sp, 8000, 0, light)[0].variance;
    };
    const double one = variance(1);
    EXPECT_LT(variance(4), 0.6 * one) << c.name;
    EXPECT_LT(variance(8), 0.55 * one) << c.name;
    ++compared;
  }
  EXPECT_GT(compared, 0);
}

TEST(DirectionSampler, ResampledDirectionsHaveTheDensityOfCandidates) {
  Guide guide(0.4f, false);
  guide.sampler.candidates = 4;
  int resampled = 0;
  for (const testing::BsdfCase& c : materials({0.3f, 0.8f})) {
    const SurfacePoint sp = make_point(c);
    for (uint32_t i = 0; i < 200; ++i) {
      Sampler u = numbers(i);
      const BsdfSample s = guide.sampler.sample(sp, u);
      if (!s.valid || s.delta) continue;
      const BsdfEval e = eval_pdf(sp, s.wi);
      ASSERT_NEAR(s.pdf_w / guide.sampler.pdf(sp, s.wi, e), 1.0f, 2e-3f) << c.name;
      const Rgb expected = e.f * (s.resampling * shading_cosine(sp, s.wi) / s.pdf_w);
      for (int k = 0; k < 3; ++k) ASSERT_NEAR(s.weight[k], expected[k], 5e-3f * expected[k] + 1e-6f) << c.name;
      if (s.resampling != 1.0f) ++resampled;
      if (!can_resample(sp)) {
        ASSERT_EQ(s.resampling, 1.0f) << c.name;
      }
    }
  }
  EXPECT_GT(resampled, 100);
}

/// One part of the mixture has the samples of the BSDF alone, by the same numbers. The other has the guide's
/// directions.
TEST(DirectionSampler, SeparateDirectionsAreThoseOfTheMixture) {
  const Guide guide(0.3f, false);
  const Guide same(0.4f, false);  // the probability that the call requires
  int of_guide = 0;
  int of_bsdf = 0;
  for (const testing::BsdfCase& c : materials()) {
    const SurfacePoint sp = make_point(c);
    if (!has_non_delta(sp.bsdf)) continue;  // not guided
    for (uint32_t i = 0; i < 300; ++i) {
      const float u = (static_cast<float>(i) + 0.5f) / 300;
      Sampler numbers_of_both = numbers(i);
      Sampler numbers_of_bsdf = numbers(i);
      const SeparateDirection d = guide.sampler.sample_separately(sp, 0.4f, u, numbers_of_both);
      const BsdfSample& s = d.bsdf;
      ASSERT_EQ(d.guided, u >= 0.4f) << c.name;
      if (!d.guided) {
        const BsdfSample plain = DirectionSampler{}.sample(sp, numbers_of_bsdf);
        ASSERT_EQ(s.valid, plain.valid) << c.name;
        ASSERT_EQ(s.wi, plain.wi) << c.name;
        ASSERT_EQ(s.weight, plain.weight) << c.name;
        ASSERT_EQ(s.eta_scale, plain.eta_scale) << c.name;
      }
      if (s.valid && s.delta) {
        ASSERT_FLOAT_EQ(d.ratio, 1 / 0.4f) << c.name;
      }
      if (!s.valid || s.delta) continue;
      const BsdfEval e = eval_pdf(sp, s.wi);
      ASSERT_NEAR(s.pdf_w / e.pdf_forward, 1.0f, 1e-2f) << c.name;
      ASSERT_NEAR(s.pdf_w / d.ratio / same.sampler.pdf(sp, s.wi, e), 1.0f, 5e-3f) << c.name;
      const Rgb expected = e.f * (shading_cosine(sp, s.wi) / s.pdf_w);
      for (int k = 0; k < 3; ++k) ASSERT_NEAR(s.weight[k], expected[k], 2e-2f * expected[k] + 1e-6f) << c.name;
      ++(d.guided ? of_guide : of_bsdf);
    }
  }
  EXPECT_GT(of_guide, 1000);
  EXPECT_GT(of_bsdf, 1000);
}

TEST(DirectionSampler, SeparateDirectionsLackTheGuideOnRequest) {
  const Guide guide(0.3f, false);
  const SurfacePoint sp = make_point(materials().back());
  Sampler a = numbers(1);
  Sampler b = numbers(1);
  const SeparateDirection d = guide.sampler.sample_separately(sp, 1, 0.99f, a);
  EXPECT_EQ(d.bsdf.wi, DirectionSampler{}.sample(sp, b).wi);
  EXPECT_FALSE(d.guided);
  EXPECT_EQ(d.ratio, 1.0f);
  EXPECT_EQ(d.fraction, 1.0f);
}

TEST(DirectionSampler, EqualsTheBsdfWithoutLearnedLight) {
  const Guide guide(0.5f, false);
  const testing::BsdfCase c = materials().back();
  SurfacePoint sp = make_point(c);
  sp.region = 1;  // has no tree
  for (uint32_t i = 0; i < 100; ++i) {
    Sampler a = numbers(i);
    Sampler b = numbers(i);
    const BsdfSample guided = guide.sampler.sample(sp, a);
    const BsdfSample plain = DirectionSampler{}.sample(sp, b);
    ASSERT_EQ(guided.wi, plain.wi);
    ASSERT_EQ(guided.pdf_w, plain.pdf_w);
    ASSERT_EQ(guide.sampler.pdf(sp, plain.wi, eval_pdf(sp, plain.wi)), eval_pdf(sp, plain.wi).pdf_forward);
  }
}

}  // namespace
}  // namespace relume
