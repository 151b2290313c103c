// Contract of every lobe and every material: samples follow the density, weights are f cos / pdf, and the reverse
// density is the forward density of the reversed pair.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "materials/testing/bsdf_charts.h"
#include "sampling/warp.h"
#include "testing/histogram.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::BsdfCase;
using testing::DirectionChart;
using testing::Histogram;
using testing::Random;

const std::vector<float> kLobeRoughness{0.05f, 0.15f, 0.3f, 0.6f, 1.0f};
const std::vector<float> kMaterialRoughness{0.0f, 0.2f, 0.7f};
const std::vector<float> kCosines{1.0f, 0.7f, 0.3f, 0.05f};

std::vector<BsdfCase> all_cases() {
  std::vector<BsdfCase> cases = testing::lobe_cases(kLobeRoughness);
  for (BsdfCase& c : testing::material_cases(kMaterialRoughness)) cases.push_back(std::move(c));
  return cases;
}

/// χ² test over both hemispheres. If the density integrates to less than one, the remainder is the expected share of
/// samples without a direction: invalid samples and those of delta lobes.
testing::Chi2Result chi2_of(const BsdfCase& c, const Vec3& wo, bool front_face) {
  constexpr int kBins = 14;
  constexpr int kSamples = 20000;  // 51 in a bin on average
  const Bsdf bsdf = c.make(wo.z, front_face);
  BsdfCase seen = c;
  if (!front_face) seen.eta = 1.0f / c.eta;
  const testing::PeakDirections peaks = testing::peak_directions(seen, wo);
  const DirectionChart charts[2] = {{make_frame(peaks.above), peaks.width}, {make_frame(peaks.below), peaks.width}};
  std::vector<uint64_t> counts(2 * kBins * kBins + 1, 0);
  Random random(31);
  for (int i = 0; i < kSamples; ++i) {
    const float u_lobe = random.next();
    const BsdfSample s = sample(bsdf, wo, u_lobe, random.next_2d());
    if (!s.valid || s.delta) {
      ++counts.back();
      continue;
    }
    const int side = s.wi.z > 0.0f ? 0 : 1;
    const Vec2 p = charts[side].coordinates(s.wi);
    const int x = std::min(static_cast<int>(p.x * kBins), kBins - 1);
    const int y = std::min(static_cast<int>(p.y * kBins), kBins - 1);
    ++counts[static_cast<size_t>((int64_t{side} * kBins + y) * kBins + x)];
  }
  std::vector<double> expected;
  double inside = 0;
  for (int side = 0; side < 2; ++side) {
    const auto pdf = [&](const Vec3& wi) {
      return (wi.z > 0.0f) == (side == 0) ? double(eval_pdf(bsdf, wo, wi).pdf_forward) : 0.0;
    };
    for (const double p : Histogram::integrals(charts[side].density(pdf), kBins, 1e-6, 5)) {
      expected.push_back(p * kSamples);
      inside += p;
    }
  }
  bool ends_abruptly = false;  // at the horizon, as for sheen
  for (int i = 0; i < bsdf.lobe_count; ++i) ends_abruptly = ends_abruptly || bsdf.lobes[i].kind == LobeKind::sheen;
  EXPECT_LT(inside, 1.0 + (ends_abruptly ? 1.5e-3 : 3e-4)) << c.name;  // accuracy of the quadrature
  expected.push_back(std::max(1.0 - inside, 0.0) * kSamples);
  // The horizon cuts bins, and quadrature misses slivers of them. Another test ensures that no sample has zero density.
  constexpr double kMaxStrays = 5e-4;
  return testing::chi2_test(counts, expected, kMaxStrays);
}

void expect_samples_follow(const std::vector<BsdfCase>& cases, const std::vector<float>& cosines) {
  for (const BsdfCase& c : cases) {
    for (const float cos_o : cosines) {
      const Vec3 wo = testing::viewer(cos_o);
      EXPECT_GT(chi2_of(c, wo, true).p_value, testing::significance()) << c.name << ", cos " << cos_o;
    }
    if (c.eta == 1.0f) continue;
    EXPECT_GT(chi2_of(c, testing::viewer(0.7f), false).p_value, testing::significance()) << c.name << ", from behind";
  }
}

/// The densities of diffuse lobes do not depend on roughness or on the distribution of normals: two cases of each
/// suffice, which differ in both. Lambert's lobe, which has neither, is one case.
TEST(BsdfSampling, LobesFollowTheirDensity) {
  std::vector<BsdfCase> cases = testing::lobe_cases(kLobeRoughness);
  std::erase_if(cases, [](const BsdfCase& c) {
    if (is_glossy(c.make(1, true).lobes[0].kind)) return false;
    return !c.name.ends_with("r 0.05, ggx") && !c.name.ends_with("r 1.00, beckmann");
  });
  const auto repeated = std::ranges::unique(cases, {}, &BsdfCase::name);  // Lambert's lobe
  cases.erase(repeated.begin(), repeated.end());
  expect_samples_follow(cases, kCosines);
}

void expect_samples_of_materials(float roughness, MicrofacetModel model, const std::vector<float>& cosines) {
  std::vector<BsdfCase> cases = testing::material_cases({roughness});
  std::erase_if(cases, [&](const BsdfCase& c) { return !c.name.ends_with(testing::to_string(model)); });
  expect_samples_follow(cases, cosines);
}

/// Materials with GGX, and with Beckmann's distribution at one roughness: their lobes are tested with both at five, at
/// all angles. Probabilities of lobes depend on roughness and angle: each material sees all angles, three of them at
/// the middle roughness.
TEST(BsdfSampling, MaterialsFollowTheirDensity) {
  const std::vector<float>& r = kMaterialRoughness;
  expect_samples_of_materials(r[0], MicrofacetModel::ggx, {0.7f});
  expect_samples_of_materials(r[1], MicrofacetModel::ggx, {1.0f, 0.3f, 0.05f});
  expect_samples_of_materials(r[1], MicrofacetModel::beckmann, {0.3f});
  expect_samples_of_materials(r[2], MicrofacetModel::ggx, {0.05f});
}
TEST(SlowBsdfSampling, MaterialsFollowTheirDensity) {
  const std::vector<float>& r = kMaterialRoughness;
  expect_samples_of_materials(r[0], MicrofacetModel::ggx, {1.0f, 0.3f});
  for (const MicrofacetModel model : {MicrofacetModel::ggx, MicrofacetModel::beckmann})
    expect_samples_of_materials(r[1], model, kCosines);
  expect_samples_of_materials(r[2], MicrofacetModel::ggx, {0.7f, 0.05f});
}

TEST(BsdfSampling, WeightIsValueTimesCosineOverDensity) {
  Random random(32);
  for (const BsdfCase& c : all_cases()) {
    for (const float cos_o : kCosines) {
      const Vec3 wo = testing::viewer(cos_o);
      const Bsdf bsdf = c.make(cos_o, true);
      for (int i = 0; i < 200; ++i) {
        const float u_lobe = random.next();
        const BsdfSample s = sample(bsdf, wo, u_lobe, random.next_2d());
        if (!s.valid) continue;
        ASSERT_NEAR(glm::length(s.wi), 1.0f, 1e-5f) << c.name;
        ASSERT_TRUE(is_finite(s.weight)) << c.name;
        ASSERT_GE(min_component(s.weight), 0.0f) << c.name;
        if (s.delta) continue;
        const BsdfEval e = eval_pdf(bsdf, wo, s.wi);
        ASSERT_GT(e.pdf_forward, 0.0f) << c.name;
        ASSERT_FLOAT_EQ(e.pdf_forward, s.pdf_w) << c.name;
        const Rgb expected = e.f * (std::fabs(s.wi.z) / e.pdf_forward);
        // Both sides use the same formula; only the order of roundings may differ.
        ASSERT_LT(max_component(abs(s.weight - expected)), 1e-5f * (1.0f + max_component(expected))) << c.name;
      }
    }
  }
}

TEST(BsdfSampling, SurvivesTheEdgesOfTheRandomNumbers) {
  for (const BsdfCase& c : all_cases()) {
    for (const float cos_o : {1.0f, 0.3f, 1e-3f}) {
      const Bsdf bsdf = c.make(cos_o, true);
      for (const float u_lobe : {0.0f, 0.5f, kOneMinusEpsilon}) {
        for (const float x : {0.0f, 0.5f, kOneMinusEpsilon}) {
          for (const float y : {0.0f, 0.5f, kOneMinusEpsilon}) {
            const BsdfSample s = sample(bsdf, testing::viewer(cos_o), u_lobe, {x, y});
            if (!s.valid) continue;
            ASSERT_TRUE(is_finite(s.wi) && is_finite(s.weight) && is_finite(s.pdf_w))
                << c.name << ' ' << cos_o << ' ' << x << ' ' << y;
          }
        }
      }
    }
  }
}

/// A direction for pairs: half of them sampled, half uniform.
Vec3 some_wi(const Bsdf& bsdf, const Vec3& wo, Random& random) {
  if (random.next() < 0.5f) {
    const float u_lobe = random.next();
    const BsdfSample s = sample(bsdf, wo, u_lobe, random.next_2d());
    if (s.valid && !s.delta && std::fabs(s.wi.z) > 1e-3f) return s.wi;
  }
  for (;;) {
    const Vec3 w = random.direction();
    if (std::fabs(w.z) > 1e-3f) return w;
  }
}

/// Calls check(bsdf, wo, wi, reversed bsdf, reversed wo, reversed wi) for many pairs of every case. The reversed pair
/// has the viewer at wi and the light from wo, in the viewer's own frame.
template <typename Check>
void for_reversed_pairs(const Check& check) {
  Random random(33);
  for (const BsdfCase& c : all_cases()) {
    for (const float cos_o : kCosines) {
      const Vec3 wo = testing::viewer(cos_o);
      const Bsdf bsdf = c.make(cos_o, true);
      if (bsdf.empty()) continue;
      for (int i = 0; i < 60; ++i) {
        const Vec3 wi = some_wi(bsdf, wo, random);
        const bool front = wi.z > 0.0f;
        const Bsdf reversed = c.make(std::fabs(wi.z), front);
        check(c, bsdf, wo, wi, reversed, front ? wi : -wi, front ? wo : -wo);
        if (::testing::Test::HasFailure()) return;
      }
    }
  }
}

TEST(BsdfSampling, ReverseDensityIsTheForwardOneOfTheReversedPair) {
  for_reversed_pairs([](const BsdfCase& c, const Bsdf& bsdf, const Vec3& wo, const Vec3& wi, const Bsdf& reversed,
                        const Vec3& ro, const Vec3& ri) {
    const float reverse = eval_pdf<true>(bsdf, wo, wi).pdf_reverse;
    const float forward = eval_pdf(reversed, ro, ri).pdf_forward;
    // Normalising the half vectors of nearly grazing pairs loses a few digits for a narrow lobe.
    ASSERT_NEAR(reverse, forward, 2e-3f * forward + 1e-6f) << c.name << " wo.z " << wo.z << " wi.z " << wi.z;
  });
}

TEST(BsdfSampling, IsReciprocalAndScalesByTheSquaredIndex) {
  for_reversed_pairs([](const BsdfCase& c, const Bsdf& bsdf, const Vec3& wo, const Vec3& wi, const Bsdf& reversed,
                        const Vec3& ro, const Vec3& ri) {
    const Rgb f = eval_pdf(bsdf, wo, wi).f;
    const Rgb back = eval_pdf(reversed, ro, ri).f;
    ASSERT_GE(min_component(f), 0.0f) << c.name;
    ASSERT_TRUE(is_finite(f)) << c.name;
    // f(wi → wo) / ηo² = f(wo → wi) / ηi² ([Veach97], eq. 5.14); η is the same on both sides of a reflection.
    const float scale = wi.z > 0.0f ? 1.0f : 1.0f / sqr(c.eta);
    const float tolerance = 2e-3f * max_component(f) + 1e-6f;
    ASSERT_LT(max_component(abs(f - back * scale)), tolerance) << c.name << " wo.z " << wo.z << " wi.z " << wi.z;
    // The adjoint is the BSDF with its arguments exchanged ([Veach97], §3.7.5).
    const Rgb adjoint = eval_pdf(bsdf, wo, wi, TransportMode::importance).f;
    ASSERT_LT(max_component(abs(adjoint - back)), 2e-3f * max_component(back) + 1e-6f) << c.name;
  });
}

}  // namespace
}  // namespace relume
