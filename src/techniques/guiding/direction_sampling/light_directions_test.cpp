// Direction sampling for light subpaths: the contract of direction_sampler_test.cpp with importance.
#include <gtest/gtest.h>

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

/// The density integrates to one: the histogram has the rejected directions and those of delta lobes as one more bin.
TEST(LightDirections, FollowTheDensityOfTheMixture) {
  constexpr int kDepth = 6;
  constexpr int kLeast = 2;
  constexpr double kTolerance = 0.1 / kMixtureSamples;
  constexpr double kMaxStrays = 5e-4;  // the horizon cuts bins
  const Guide guide(0.4f, false);
  for (const testing::BsdfCase& c : materials({0.3f})) {
    if (c.name.ends_with(testing::to_string(MicrofacetModel::beckmann))) continue;
    const SurfacePoint sp = make_point(c);
    const testing::DirectionChart chart = chart_of(c, sp);
    const auto pdf = [&](const Vec3& w) {
      const BsdfEval e = eval_pdf(sp, w, TransportMode::importance);
      return is_black(e.f) ? 0.0 : double{guide.sampler.importance_pdf(guide.sampler.guided(sp), w, e.pdf_forward)};
    };
    const std::vector<double> expected =
        testing::Histogram::integrals(chart.density(pdf), kBins, kTolerance, kDepth, kLeast);
    const testing::Histogram found = histogram_of(guide, sp, chart, TransportMode::importance);
    EXPECT_GT(found.test_against(expected, kMaxStrays).p_value, testing::significance()) << c.name;
  }
}

TEST(LightDirections, HaveTheWeightsOfImportance) {
  const Guide guide(0.3f, false);
  int guided = 0;
  for (const testing::BsdfCase& c : materials()) {
    const SurfacePoint sp = make_point(c);
    const GuidedPoint point = guide.sampler.guided(sp);
    for (uint32_t i = 0; i < 500; ++i) {
      Sampler u = numbers(i);
      const BsdfSample s = guide.sampler.sample(sp, u, TransportMode::importance);
      if (!s.valid || s.delta) continue;
      const BsdfEval e = eval_pdf(sp, s.wi, TransportMode::importance);
      ASSERT_NEAR(s.pdf_w / guide.sampler.importance_pdf(point, s.wi, e.pdf_forward), 1.0f, 2e-3f) << c.name;
      ASSERT_NEAR(s.bsdf_pdf_w / e.pdf_forward, 1.0f, 1e-2f) << c.name;
      ASSERT_NEAR(s.eta_scale * s.pdf_w / e.pdf_forward, 1.0f, 1e-2f) << c.name;  // refraction scales no importance
      const Rgb expected = e.f * (shading_cosine(sp, s.wi) / s.pdf_w);
      for (int k = 0; k < 3; ++k) ASSERT_NEAR(s.weight[k], expected[k], 5e-3f * expected[k] + 1e-6f) << c.name;
      ++guided;
    }
    EXPECT_EQ(guide.sampler.importance_fraction(point), has_non_delta(sp.bsdf) ? 0.3f : 1.0f) << c.name;
  }
  EXPECT_GT(guided, 1000);
}

TEST(LightDirections, FollowTheBsdfWhereNothingWasLearned) {
  const Guide guide(0.5f, false);
  const testing::BsdfCase c = materials().back();
  SurfacePoint elsewhere = make_point(c);
  elsewhere.region = 1;  // has no tree
  const auto expect_bsdf = [&](const SurfacePoint& sp) {
    for (uint32_t i = 0; i < 100; ++i) {
      Sampler a = numbers(i);
      Sampler b = numbers(i);
      const BsdfSample s = guide.sampler.sample(sp, a, TransportMode::importance);
      const BsdfSample plain = DirectionSampler{}.sample(sp, b, TransportMode::importance);
      ASSERT_EQ(s.wi, plain.wi);
      ASSERT_EQ(s.pdf_w, plain.pdf_w);
      ASSERT_EQ(s.weight, plain.weight);
      ASSERT_EQ(guide.sampler.importance_pdf(guide.sampler.guided(sp), s.wi, 0.25f), 0.25f);
    }
    EXPECT_EQ(guide.sampler.importance_fraction(guide.sampler.guided(sp)), 1.0f);
  };
  expect_bsdf(elsewhere);
  guide.store_importance(uniform_quadtree(128));
  expect_bsdf(make_point(c));
}

}  // namespace
}  // namespace relume
