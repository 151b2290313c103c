#include "materials/ltc.h"

#include <gtest/gtest.h>

#include "materials/microfacet.h"
#include "testing/histogram.h"
#include "testing/random.h"

namespace relume {
namespace {

Triple<float> triple(const Vec3& v) { return {v.x, v.y, v.z}; }

/// ∫ cos θ / π dω over the part of the triangle above the horizon, from points on the triangle.
double form_factor_by_points(const Vec3& v0, const Vec3& v1, const Vec3& v2, int n) {
  const glm::dvec3 a(v0);
  const glm::dvec3 e1 = glm::dvec3(v1) - a;
  const glm::dvec3 e2 = glm::dvec3(v2) - a;
  const glm::dvec3 normal = glm::cross(e1, e2);  // length is twice the area
  double sum = 0;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < 2 * i + 1; ++j) {  // centres of n² small triangles of equal area
      const double s = (j / 2 + (j % 2 == 0 ? 1.0 / 3 : 2.0 / 3)) / n;
      const double t = (i - j / 2 + (j % 2 == 0 ? 1.0 / 3 : -1.0 / 3)) / n;
      const glm::dvec3 p = a + s * e1 + t * e2;
      const double d2 = glm::dot(p, p);
      if (p.z > 0) sum += p.z * std::fabs(glm::dot(normal, p)) / (d2 * d2);
    }
  }
  return sum * 0.5 / (n * n) / M_PI;
}

TEST(Ltc, FormFactorIsTheIntegralOfTheCosine) {
  testing::Random random(1);
  int clipped = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 middle = random.direction() * (1.0f + random.next());
    const Vec3 v[3] = {middle + random.point(0.5f), middle + random.point(0.5f), middle + random.point(0.5f)};
    const bool above = v[0].z > 0;
    clipped += (v[1].z > 0) != above || (v[2].z > 0) != above;
    const double expected = form_factor_by_points(v[0], v[1], v[2], 300);
    // The points resolve an edge at the horizon to about 1/300 of its length.
    EXPECT_NEAR(ltc::form_factor(triple(v[0]), triple(v[1]), triple(v[2])), expected, 2e-4 + 2e-3 * expected) << i;
  }
  EXPECT_GE(clipped, 40);
}

TEST(Ltc, FormFactorStaysExactForSmallTriangles) {
  testing::Random random(2);
  for (float size = 1.0f; size > 1e-5f; size *= 0.5f) {
    const Vec3 middle(0.6f, -0.5f, 1.1f);
    const Vec3 v[3] = {middle, middle + size * Vec3(0.1f, 0.02f, -0.05f), middle + size * Vec3(-0.03f, 0.1f, 0.04f)};
    const double expected = form_factor_by_points(v[0], v[1], v[2], 40);
    EXPECT_NEAR(ltc::form_factor(triple(v[0]), triple(v[1]), triple(v[2])) / expected, 1.0, 0.01) << size;
  }
}

TEST(Ltc, FormFactorOfHalfTheWorldIsOne) {
  // A large triangle close above covers nearly the whole hemisphere; one below the horizon contributes nothing.
  EXPECT_NEAR(ltc::form_factor<float>({-1e4f, -1e4f, 1}, {2e4f, -1e4f, 1}, {-1e4f, 2e4f, 1}), 1.0f, 1e-3f);
  EXPECT_EQ(ltc::form_factor<float>({-1, -1, -1}, {2, -1, -1}, {-1, 2, -1}), 0.0f);
}

TEST(Ltc, DensityOfEveryEntryIntegratesToOne) {
  for (const float cos_theta : {1.0f, 0.7f, 0.3f, 0.05f}) {
    for (const float r : {0.3f, 0.5f, 0.8f, 1.0f}) {
      const LtcMatrix m = ltc_table().at(cos_theta, r);
      const testing::DirectionChart chart{testing::local_frame(), 1.0};
      const auto pdf = [&](const Vec3& w) { return static_cast<double>(ltc_pdf(m, w)); };
      EXPECT_NEAR(testing::integrate_square(chart.density(pdf), 16, 1e-6, 5), 1.0, 2e-3) << cos_theta << " " << r;
    }
  }
}

/// Half of ∫ |f − g| over directions: the share of samples to move to turn one density into the other.
double distance(float cos_theta, float r) {
  const Microfacet ggx{MicrofacetModel::ggx, r * r};
  const LtcMatrix m = ltc_table().at(cos_theta, r);
  const Vec3 wo(std::sqrt(1.0f - cos_theta * cos_theta), 0, cos_theta);
  const testing::DirectionChart chart{make_frame(Vec3(-wo.x, -wo.y, wo.z)), 0.1};
  const auto reflected = [&](const Vec3& wi) {
    if (wi.z <= 0) return 0.0;
    const Vec3 h = glm::normalize(wo + wi);
    return static_cast<double>(ggx.d(h) * ggx.g2(wo, wi) / (4.0f * wo.z));
  };
  const auto albedo = testing::integrate_square(chart.density(reflected), 16, 1e-6, 5);
  const auto difference = [&](const Vec3& w) {
    return 0.5 * std::fabs(reflected(w) / albedo - static_cast<double>(ltc_pdf(m, w)));
  };
  return testing::integrate_square(chart.density(difference), 24, 1e-5, 3);
}

TEST(Ltc, TableFollowsTheReflectionOfGgx) {
  // No transformed cosine is GGX: the distance is at least a tenth. At grazing angles: up to a third ([Heitz16], §3.4).
  for (const float r : {0.2f, 0.35f, 0.6f, 0.9f}) {
    EXPECT_LT(distance(0.99f, r), 0.15) << r;
    EXPECT_LT(distance(0.6f, r), 0.2) << r;
    EXPECT_LT(distance(0.15f, r), 0.35) << r;
  }
}

TEST(Ltc, LanesGiveTheBitsOfSingleNumbers) {
  testing::Random random(4);
  for (int round = 0; round < 200; ++round) {
    float columns[9][8];
    for (auto& column : columns) {
      for (float& x : column) x = 4.0f * random.next() - 2.0f;
    }
    const auto lanes = [&](int k) {
      return Triple<Lanes>{load_lanes(columns[k]), load_lanes(columns[k + 1]), load_lanes(columns[k + 2])};
    };
    const Lanes result = ltc::form_factor(lanes(0), lanes(3), lanes(6));
    for (int i = 0; i < 8; ++i) {
      const auto one = [&](int k) { return Triple<float>{columns[k][i], columns[k + 1][i], columns[k + 2][i]}; };
      ASSERT_EQ(result[i], ltc::form_factor(one(0), one(3), one(6)));
    }
  }
}

}  // namespace
}  // namespace relume
