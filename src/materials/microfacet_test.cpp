#include "materials/microfacet.h"

#include <gtest/gtest.h>

#include <new>

#include "materials/energy_table_arrays.h"
#include "materials/fresnel.h"
#include "materials/testing/bsdf_cases.h"
#include "testing/failing_memory.h"
#include "testing/histogram.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::DirectionChart;
using testing::Histogram;
using testing::Random;

/// Both models at several widths.
std::vector<Microfacet> distributions() {
  std::vector<Microfacet> list;
  for (const MicrofacetModel model : {MicrofacetModel::ggx, MicrofacetModel::beckmann}) {
    for (const float alpha : {0.0025f, 0.04f, 0.25f, 0.6f, 1.0f}) list.push_back({model, alpha});
  }
  return list;
}

std::string name_of(const Microfacet& m) { return testing::to_string(m.model) + ", alpha " + std::to_string(m.alpha); }

template <typename F>
double integrate_normals(const Microfacet& m, const F& f) {
  const DirectionChart chart{testing::local_frame(), m.alpha};
  return testing::integrate_square(chart.density(f), 16, 1e-6, 6);
}

TEST(Microfacet, ProjectedNormalsCoverTheSurface) {
  for (const Microfacet& mf : distributions()) {
    const auto projected = [&](const Vec3& m) { return m.z > 0.0f ? double(mf.d(m) * m.z) : 0.0; };
    EXPECT_NEAR(integrate_normals(mf, projected), 1.0, 3e-4) << name_of(mf);  // float normals near the axis
  }
}

TEST(Microfacet, VisibleNormalsProjectToTheViewer) {
  // ∫ G1 ⟨wo, m⟩ D dm = cos θo ([Heitz14], eq. 14). The fit of Beckmann's Λ is off by up to 0.4 %.
  for (const Microfacet& mf : distributions()) {
    for (const float cos_o : {0.95f, 0.5f, 0.1f}) {
      const Vec3 wo = testing::viewer(cos_o);
      const auto visible = [&](const Vec3& m) {
        return m.z > 0.0f ? double(mf.g1(wo) * std::fmax(0.0f, glm::dot(wo, m)) * mf.d(m)) : 0.0;
      };
      const double tolerance = mf.model == MicrofacetModel::ggx ? 5e-4 : 4e-3;
      EXPECT_NEAR(integrate_normals(mf, visible) / cos_o, 1.0, tolerance) << name_of(mf) << ", cos " << cos_o;
    }
  }
}

TEST(Microfacet, SampledNormalsFollowTheirDensity) {
  for (const Microfacet& mf : distributions()) {
    for (const float cos_o : {1.0f, 0.5f, 0.05f}) {
      const Vec3 wo = testing::viewer(cos_o);
      const DirectionChart chart{testing::local_frame(), mf.alpha};
      Histogram histogram(14);
      Random random(51);
      for (int i = 0; i < 50000; ++i) {
        const Vec3 m = mf.sample(wo, random.next_2d());
        ASSERT_NEAR(glm::length(m), 1.0f, 1e-5f);
        ASSERT_GE(m.z, 0.0f);
        const Vec2 p = chart.coordinates(m);
        histogram.add(p.x, p.y);
      }
      const auto pdf = [&](const Vec3& m) { return m.z > 0.0f ? double(mf.pdf(wo, m)) : 0.0; };
      EXPECT_GT(histogram.test(chart.density(pdf)).p_value, testing::significance())
          << name_of(mf) << ", cos " << cos_o;
    }
  }
}

TEST(Microfacet, MaskingStaysBetweenZeroAndOne) {
  Random random(52);
  for (const Microfacet& mf : distributions()) {
    for (int i = 0; i < 1000; ++i) {
      Vec3 wo = random.direction();
      Vec3 wi = random.direction();
      wo.z = std::fabs(wo.z);
      wi.z = std::fabs(wi.z);
      const float g2 = mf.g2(wo, wi);
      ASSERT_GE(g2, 0.0f);
      ASSERT_LE(g2, std::fmin(mf.g1(wo), mf.g1(wi)));
      ASSERT_GE(g2, mf.g1(wo) * mf.g1(wi) - 1e-6f);  // correlated heights mask less
    }
    for (int i = 0; i < 1000; ++i) {
      const float angle = (static_cast<float>(i) + 0.5f) / 1000 * 0.5f * kPi;
      ASSERT_GE(mf.lambda({std::sin(angle), 0, std::cos(angle)}), 0.0f) << name_of(mf) << ", angle " << angle;
    }
    EXPECT_EQ(mf.g1({0, 0, 1}), 1.0f);
    EXPECT_EQ(mf.g1({1, 0, 0}), 0.0f);
  }
}

TEST(Fresnel, MatchesKnownValues) {
  EXPECT_NEAR(fresnel_dielectric(1.0f, 1.5f), 0.04f, 1e-6f);
  EXPECT_NEAR(fresnel_dielectric(1.0f, 1.0f / 1.5f), 0.04f, 1e-6f);
  EXPECT_NEAR(f0_from_ior(1.5f), 0.04f, 1e-7f);
  EXPECT_NEAR(fresnel_dielectric(0.0f, 1.5f), 1.0f, 1e-6f);
  // 60° on n = 1.5: sin² t = 1/3 by Snell, so cos t = √(2/3).
  // rs = (cos i − n cos t)/(cos i + n cos t), rp = (n cos i − cos t)/(n cos i + cos t).
  const double root = std::sqrt(2.0 / 3.0);
  const double rs = (0.5 - 1.5 * root) / (0.5 + 1.5 * root);
  const double rp = (0.75 - root) / (0.75 + root);
  EXPECT_NEAR(fresnel_dielectric(0.5f, 1.5f), 0.5 * (rs * rs + rp * rp), 1e-6);
}

TEST(Fresnel, ParallelLightVanishesAtBrewstersAngle) {
  // tan θB = n: only the perpendicular part is reflected, by ((1 − n²)/(1 + n²))².
  for (const double n : {1.33, 1.5, 2.4}) {
    const double perpendicular = std::pow((1.0 - n * n) / (1.0 + n * n), 2);
    const auto cos_b = static_cast<float>(1.0 / std::sqrt(1.0 + n * n));
    EXPECT_NEAR(fresnel_dielectric(cos_b, static_cast<float>(n)), 0.5 * perpendicular, 1e-6);
  }
}

TEST(Fresnel, ReflectsTotallyBeyondTheCriticalAngle) {
  const double sin_c = 1.0 / 1.5;
  const auto cos_c = static_cast<float>(std::sqrt(1.0 - sin_c * sin_c));
  Vec3 wi;
  for (const float cos_i : {cos_c - 1e-3f, 0.5f, 0.0f}) {
    EXPECT_EQ(fresnel_dielectric(cos_i, 1.0f / 1.5f), 1.0f);
    EXPECT_FALSE(refract(testing::viewer(cos_i), Vec3(0, 0, 1), 1.0f / 1.5f, &wi));
  }
  EXPECT_LT(fresnel_dielectric(cos_c + 1e-3f, 1.0f / 1.5f), 1.0f);
}

TEST(Fresnel, IsTheSameFromBothSides) {
  for (const float cos_o : {0.9f, 0.5f, 0.1f}) {
    Vec3 wi;
    ASSERT_TRUE(refract(testing::viewer(cos_o), Vec3(0, 0, 1), 1.5f, &wi));
    EXPECT_NEAR(glm::length(wi), 1.0f, 1e-6f);
    EXPECT_NEAR(std::hypot(wi.x, wi.y) * 1.5f, safe_sqrt(1.0f - cos_o * cos_o), 1e-6f);  // Snell's law
    EXPECT_NEAR(fresnel_dielectric(cos_o, 1.5f), fresnel_dielectric(-wi.z, 1.0f / 1.5f), 1e-5f);
  }
}

TEST(Fresnel, SchlickMeetsItsEnds) {
  const Rgb f0(0.04f, 0.5f, 0.9f);
  EXPECT_EQ(fresnel_schlick(f0, Rgb(1), 1.0f), f0);
  EXPECT_EQ(fresnel_schlick(f0, Rgb(1), 0.0f), Rgb(1));
}

TEST(EnergyTables, LookUpsMatchQuadrature) {
  for (const MicrofacetModel model : {MicrofacetModel::ggx, MicrofacetModel::beckmann}) {
    for (const float r : {0.0317f, 0.06f, 0.13f, 0.27f, 0.44f, 0.71f, 1.0f}) {
      const Microfacet mf{model, r * r};
      for (const float cos_o : {0.99f, 0.6f, 0.2f, 0.05f, 0.013f}) {
        const Vec3 wo(safe_sqrt(1.0f - cos_o * cos_o), 0, cos_o);
        double total = 0;
        double grazing = 0;
        constexpr int kPoints = 200;
        for (int i = 0; i < kPoints * kPoints; ++i) {
          // Squared: dense points in the tail.
          const double t = (i / kPoints + 0.5) / kPoints;
          const Vec3 m =
              mf.sample(wo, {static_cast<float>((i % kPoints + 0.5) / kPoints), static_cast<float>(1.0 - t * t)});
          const float cos_om = glm::dot(wo, m);
          const Vec3 wi = reflect(wo, m);
          if (cos_om <= 0.0f || wi.z <= 0.0f) continue;
          const double weight = 2 * t * mf.d(m) * mf.g2(wo, wi) * cos_om / (wo.z * mf.pdf(wo, m)) / (kPoints * kPoints);
          total += weight;
          grazing += weight * pow5(1.0f - cos_om);
        }
        const EnergyShares shares = energy_tables().of(model).directional_shares(cos_o, r);
        EXPECT_NEAR(shares.total, total, 1e-3) << name_of(mf) << ", cos " << cos_o;
        EXPECT_NEAR(shares.grazing, grazing, 1e-3) << name_of(mf) << ", cos " << cos_o;
      }
    }
  }
}

TEST(EnergyTables, AreExactForSmoothSurfaces) {
  const EnergyTable& table = energy_tables().ggx;
  EXPECT_EQ(table.directional_shares(0.5f, 0.0f).total, 1.0f);
  EXPECT_EQ(table.directional_shares(0.5f, 0.0f).grazing, pow5(0.5f));
  EXPECT_EQ(table.average_shares(0.01f).total, 1.0f);
  EXPECT_NEAR(table.average_shares(0.01f).grazing, 1.0 / 21.0, 1e-7);
}

TEST(EnergyTables, CopiesHaveTheSameLookUps) {
  EnergyTableArrays copies;
  for (const bool layered : {false, true, false}) {
    copies.update({.anisotropic = layered, .sheen = layered});
    const EnergyTables tables = copies.view();
    const EnergyTables& expected = layered_energy_tables({.anisotropic = layered, .sheen = layered});
    for (const MicrofacetModel model : {MicrofacetModel::ggx, MicrofacetModel::beckmann}) {
      EXPECT_NE(tables.of(model).directional.data, expected.of(model).directional.data);
      EXPECT_EQ(tables.of(model).directional_shares(0.3f, 0.4f).total,
                expected.of(model).directional_shares(0.3f, 0.4f).total);
      EXPECT_EQ(tables.of(model).average_shares(0.4f).grazing, expected.of(model).average_shares(0.4f).grazing);
    }
    EXPECT_EQ(tables.anisotropic.directional.empty(), !layered);
    EXPECT_EQ(tables.sheen.albedo.empty(), !layered);
    if (!layered) continue;
    EXPECT_EQ(tables.sheen.directional(0.3f, 0.4f), expected.sheen.directional(0.3f, 0.4f));
  }
}

TEST(EnergyTables, CopiesStayIfMemoryIsMissing) {
  testing::FailingMemory memory;
  EnergyTableArrays copies(memory);
  copies.update({.anisotropic = false, .sheen = false});
  const auto look_up = [&] { return copies.view().ggx.directional_shares(0.3f, 0.4f).total; };
  const float expected = look_up();
  for (int before = 0; before < 2; ++before) {
    memory.fail_after(before);
    EXPECT_THROW(copies.update({.anisotropic = true, .sheen = true}), std::bad_alloc);
    EXPECT_EQ(look_up(), expected);
    EXPECT_TRUE(copies.view().sheen.albedo.empty());
  }
  copies.update({.anisotropic = true, .sheen = true});
  EXPECT_EQ(look_up(), expected);
  EXPECT_FALSE(copies.view().sheen.albedo.empty());
}

TEST(EnergyTables, HoldTheNeededLayers) {
  for (const bool anisotropic : {true, false}) {
    for (const bool sheen : {true, false}) {
      const LayerTables needed{anisotropic, sheen};
      const EnergyTables& tables = layered_energy_tables(needed);
      EXPECT_EQ(tables.anisotropic.directional.size > 0, anisotropic);
      EXPECT_EQ(tables.sheen.albedo.size > 0, sheen);
      EXPECT_EQ(tables.ggx.directional.data, energy_tables().ggx.directional.data);
    }
  }
}

}  // namespace
}  // namespace relume
