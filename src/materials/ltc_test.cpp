#include "materials/ltc.h"

#include <gtest/gtest.h>

#include "materials/microfacet.h"
#include "testing/histogram.h"

namespace relume {
namespace {

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

}  // namespace
}  // namespace relume
