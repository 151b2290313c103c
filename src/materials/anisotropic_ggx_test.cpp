#include "materials/anisotropic_ggx.h"

#include <gtest/gtest.h>

#include "materials/testing/bsdf_cases.h"
#include "testing/histogram.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::DirectionChart;
using testing::Histogram;
using testing::Random;

std::vector<AnisotropicGgx> distributions() {
  std::vector<AnisotropicGgx> list;
  for (const float alpha : {0.04f, 0.25f, 0.6f}) {
    for (const float strength : {0.3f, 0.7f, 1.0f})
      list.push_back({lerp(alpha, 1.0f, strength * strength), alpha, strength, glm::normalize(Vec2(0.3f, -0.9f))});
  }
  return list;
}

std::string name_of(const AnisotropicGgx& mf) {
  return "alpha " + std::to_string(mf.alpha_b) + ", strength " + std::to_string(mf.strength);
}

TEST(AnisotropicGgx, WithEqualWidthsIsTheIsotropicOne) {
  const AnisotropicGgx a{0.3f, 0.3f, 0, glm::normalize(Vec2(1, 2))};
  const Microfacet b{MicrofacetModel::ggx, 0.3f};
  Random random(61);
  for (int i = 0; i < 100; ++i) {
    Vec3 w = random.direction();
    w.z = std::fabs(w.z) + 0.01f;
    w = glm::normalize(w);
    EXPECT_NEAR(a.d(w), b.d(w), 1e-4f * b.d(w));
    EXPECT_NEAR(a.lambda(w), b.lambda(w), 1e-4f * (1 + b.lambda(w)));
  }
}

TEST(AnisotropicGgx, VisibleNormalsProjectToTheViewer) {
  for (const AnisotropicGgx& mf : distributions()) {
    for (const float cos_o : {0.95f, 0.5f, 0.1f}) {
      const Vec3 wo = testing::viewer(cos_o);
      const auto visible = [&](const Vec3& m) {
        return m.z > 0.0f ? double(mf.g1(wo) * std::fmax(0.0f, glm::dot(wo, m)) * mf.d(m)) : 0.0;
      };
      const DirectionChart chart{testing::local_frame(), mf.alpha_b};
      const double sum = testing::integrate_square(chart.density(visible), 16, 1e-6, 6);
      EXPECT_NEAR(sum / cos_o, 1.0, 2e-3) << name_of(mf) << ", cos " << cos_o;
    }
  }
}

TEST(AnisotropicGgx, SampledNormalsFollowTheirDensity) {
  for (const AnisotropicGgx& mf : distributions()) {
    for (const float cos_o : {1.0f, 0.5f, 0.05f}) {
      const Vec3 wo = testing::viewer(cos_o);
      const DirectionChart chart{testing::local_frame(), mf.alpha_b};
      Histogram histogram(14);
      Random random(62);
      for (int i = 0; i < 50000; ++i) {
        const Vec3 m = mf.sample(wo, random.next_2d());
        ASSERT_NEAR(glm::length(m), 1.0f, 1e-5f);
        const Vec2 p = chart.coordinates(m);
        histogram.add(p.x, p.y);
      }
      const auto pdf = [&](const Vec3& m) { return m.z > 0.0f ? double(mf.pdf(wo, m)) : 0.0; };
      EXPECT_GT(histogram.test(chart.density(pdf)).p_value, testing::significance())
          << name_of(mf) << ", cos " << cos_o;
    }
  }
}

}  // namespace
}  // namespace relume
