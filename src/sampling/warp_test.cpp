// Contract of all warps: samples follow the density, the density integrates to one, and the inverse inverts.
#include "sampling/warp.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "sampling/spherical_parallelogram.h"
#include "testing/histogram.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::DirectionChart;
using testing::Histogram;
using testing::Random;

/// A warp onto a domain, with a chart of that domain onto the unit square.
struct Warp {
  std::string name;
  std::function<Vec3(const Vec2&)> from_square;
  std::function<Vec2(const Vec3&)> to_square;
  std::function<Vec2(const Vec3&)> chart;             ///< domain to square
  std::function<double(double x, double y)> density;  ///< over the chart's square: pdf times the chart's Jacobian
  double edge = 1;                                    ///< scale of the domain, the unit of position errors
  float tolerance = 2e-5f;  ///< of the inverse: some roundings of numbers up to π, magnified where the warp is steep
};

double cone_one_minus_cos(double angle_rad) { return 2.0 * std::pow(std::sin(0.5 * angle_rad), 2); }

/// The chart's first coordinate is sin θ/2 relative to the rim, which maps the rim to the edge of the square.
Warp cone(const std::string& name, double angle_rad) {
  const auto k = static_cast<float>(cone_one_minus_cos(angle_rad));
  const double rim = std::sin(0.5 * angle_rad);
  const auto chart = [rim](const Vec3& w) {
    const double s = 0.5 * glm::length(w - Vec3(0, 0, 1));
    return Vec2(static_cast<float>(s / rim), square_from_sphere(w).y);
  };
  return {name,
          [k](const Vec2& u) { return cone_from_square(u, k); },
          [k](const Vec3& w) { return square_from_cone(w, k); },
          chart,
          [k, rim](double x, double) { return cone_pdf(k) * 8.0 * M_PI * rim * rim * x; },
          std::min(angle_rad, 1.0)};
}

/// The chart maps to the barycentrics of the flat triangle v0 v1 v2.
Warp spherical_triangle(const std::string& name, const Vec3& v0, const Vec3& v1, const Vec3& v2) {
  const Vec3 e1 = v1 - v0;
  const Vec3 e2 = v2 - v0;
  const Vec3 n = glm::cross(e1, e2);
  const auto triple = [](const Vec3& v) { return triple_of<float>(v); };
  const auto t = make_spherical_triangle(triple(v0), triple(v1), triple(v2), std::fabs(glm::dot(v0, n)));
  const auto chart = [=](const Vec3& w) {
    const Vec3 p = w * (glm::dot(v0, n) / glm::dot(w, n)) - v0;
    return Vec2(glm::dot(glm::cross(p, e2), n), glm::dot(glm::cross(e1, p), n)) / glm::dot(n, n);
  };
  return {name,
          [t](const Vec2& u) {
            const auto w = spherical_triangle_from_square(t, u.x, u.y);
            return Vec3(w.x, w.y, w.z);
          },
          [t, triple](const Vec3& w) { return square_from_spherical_triangle(t, triple(w)); },
          chart,
          [=](double x, double y) {
            if (x + y >= 1) return 0.0;
            const glm::dvec3 p = glm::dvec3(v0) + x * glm::dvec3(e1) + y * glm::dvec3(e2);
            return t.pdf() * std::abs(glm::dot(glm::dvec3(n), p)) / std::pow(glm::length(p), 3);
          },
          std::min(1.0, double(glm::length(e1) / glm::length(v0))),
          2e-4f};  // directions of 24 bits
}

/// The chart is that of the parallelogram's own coordinates.
Warp spherical_parallelogram(const std::string& name, const Vec3& v0, const Vec3& e1, const Vec3& e2) {
  const Vec3 n = glm::cross(e1, e2);
  const auto triple = [](const Vec3& v) { return triple_of<float>(v); };
  const auto s = make_spherical_parallelogram(triple(v0), triple(e1), triple(e2), std::fabs(glm::dot(v0, n)));
  const auto chart = [=](const Vec3& w) {
    const Vec3 p = w * (glm::dot(v0, n) / glm::dot(w, n)) - v0;
    return Vec2(glm::dot(glm::cross(p, e2), n), glm::dot(glm::cross(e1, p), n)) / glm::dot(n, n);
  };
  return {name,
          [s](const Vec2& u) {
            const auto w = spherical_parallelogram_from_square(s, u.x, u.y);
            return Vec3(w.x, w.y, w.z);
          },
          [s, triple](const Vec3& w) { return square_from_spherical_parallelogram(s, triple(w)); },
          chart,
          [=](double x, double y) {
            const glm::dvec3 p = glm::dvec3(v0) + x * glm::dvec3(e1) + y * glm::dvec3(e2);
            return s.pdf() * std::abs(glm::dot(glm::dvec3(n), p)) / std::pow(glm::length(p), 3);
          },
          std::min(1.0, double(glm::length(e1) / glm::length(v0))),
          2e-4f};
}

std::vector<Warp> warps() {
  const auto chart = std::make_shared<DirectionChart>();
  std::vector<Warp> list;
  list.push_back({"disk", [](const Vec2& u) { return Vec3(disk_from_square(u), 0); },
                  [](const Vec3& p) { return square_from_disk(Vec2(p)); },
                  [](const Vec3& p) { return 0.5f * (Vec2(p) + 1.0f); },
                  [](double x, double y) { return std::hypot(2 * x - 1, 2 * y - 1) < 1 ? 4.0 * disk_pdf() : 0.0; }});
  list.push_back({"cosine hemisphere", [](const Vec2& u) { return cosine_hemisphere_from_square(u); },
                  [](const Vec3& w) { return square_from_cosine_hemisphere(w); },
                  [chart](const Vec3& w) { return chart->coordinates(w); },
                  [chart](double x, double y) {
                    const auto pdf = [](const Vec3& w) { return double(cosine_hemisphere_pdf(w.z)); };
                    return chart->density(pdf)(x, y);
                  }});
  list.push_back({"sphere", [](const Vec2& u) { return sphere_from_square(u); },
                  [](const Vec3& w) { return square_from_sphere(w); },
                  [chart](const Vec3& w) { return chart->coordinates(w); },
                  [chart](double x, double y) {
                    const auto pdf = [](const Vec3&) { return double(sphere_pdf()); };
                    return chart->density(pdf)(x, y);
                  }});
  list.push_back(cone("wide cone", 1.2));
  list.push_back(cone("obtuse cone", 2.5));
  list.push_back(cone("the sun's cone", 0.5 * 0.00925));
  list.push_back({"triangle", [](const Vec2& u) { return Vec3(triangle_from_square(u), 0); },
                  [](const Vec3& b) { return square_from_triangle(Vec2(b)); }, [](const Vec3& b) { return Vec2(b); },
                  [](double x, double y) { return x + y < 1 ? double(triangle_pdf()) : 0.0; }});
  list.push_back(spherical_triangle("near triangle", {-1, -0.5f, 0.6f}, {2, 0, 0.3f}, {0.1f, 3, 0.9f}));
  list.push_back(spherical_triangle("far triangle", {3, 4, 9}, {3.2f, 4, 9.1f}, {3, 4.5f, 9}));
  list.push_back(spherical_triangle("narrow triangle", {-5, 1, 0.2f}, {5, 1, 0.2f}, {5, 1.1f, 0.2f}));
  list.push_back(spherical_triangle("triangle around the viewer", {-1, -1, 0.1f}, {0, 1, 0.1f}, {1, -1, 0.1f}));
  list.push_back(spherical_parallelogram("near rectangle", {-1, -0.5f, 0.6f}, {2, 0, 0.3f}, {-0.15f, 2, 1}));
  list.push_back(spherical_parallelogram("sheared parallelogram", {1, 2, 3}, {2, 0.5f, 0}, {1.5f, 2, -1}));
  list.push_back(spherical_parallelogram("rectangle around the viewer", {-1, -1, 0.1f}, {2, 0, 0}, {0, 3, 0}));
  return list;
}

class WarpContract : public ::testing::TestWithParam<Warp> {};

TEST_P(WarpContract, SamplesFollowTheDensity) {
  const Warp& warp = GetParam();
  Random random(11);
  Histogram histogram(16);
  for (int i = 0; i < 200000; ++i) {
    const Vec2 p = warp.chart(warp.from_square(random.next_2d()));
    histogram.add(p.x, p.y);
  }
  EXPECT_GT(histogram.test(warp.density, 9).p_value, testing::significance());
}

TEST_P(WarpContract, DensityIntegratesToOne) {
  // Quadrature resolves discontinuous densities (the rims of disk, cone and triangle) to about 1e-4.
  EXPECT_NEAR(testing::integrate_square(GetParam().density, 32, 1e-7, 9), 1.0, 2e-4);
}

TEST_P(WarpContract, InverseInvertsBothWays) {
  const Warp& warp = GetParam();
  Random random(12);
  for (int i = 0; i < 20000; ++i) {
    // Stays away from the rim, and from the axis and pole, where angles are poorly resolved.
    const Vec2 u = random.next_2d() * 0.96f + 0.02f;
    const Vec3 p = warp.from_square(u);
    const Vec2 back = warp.to_square(p);
    ASSERT_NEAR(back.x, u.x, warp.tolerance) << warp.name << ' ' << u.x << ' ' << u.y;
    ASSERT_NEAR(back.y, u.y, warp.tolerance) << warp.name << ' ' << u.x << ' ' << u.y;
    ASSERT_LT(glm::length(warp.from_square(back) - p), warp.tolerance * warp.edge) << warp.name;
  }
}

TEST_P(WarpContract, StaysInItsDomainAtTheEdges) {
  const Warp& warp = GetParam();
  for (const float x : {0.0f, 0.5f, kOneMinusEpsilon}) {
    for (const float y : {0.0f, 0.5f, kOneMinusEpsilon}) {
      const Vec3 p = warp.from_square({x, y});
      ASSERT_TRUE(is_finite(p)) << warp.name;
      const Vec2 back = warp.to_square(p);
      for (int c = 0; c < 2; ++c) {
        EXPECT_GE(back[c], -warp.tolerance) << warp.name;
        EXPECT_LE(back[c], 1.0f + warp.tolerance) << warp.name;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, WarpContract, ::testing::ValuesIn(warps()), [](const auto& warp) {
  std::string name = warp.param.name;
  std::erase_if(name, [](char c) { return !std::isalnum(static_cast<unsigned char>(c)); });
  return name;
});

TEST(Warp, CosineHemisphereStaysAbove) {
  Random random(13);
  for (int i = 0; i < 10000; ++i) {
    const Vec3 w = cosine_hemisphere_from_square(random.next_2d());
    ASSERT_GE(w.z, 0.0f);
    ASSERT_NEAR(glm::length(w), 1.0f, 1e-6f);
  }
}

TEST(Warp, ConvertsMeasures) {
  // 1/A = 2 per m², seen from 3 m away at 60°.
  EXPECT_FLOAT_EQ(pdf_w_from_pdf_a(2.0f, 9.0f, 0.5f), 36.0f);
}

}  // namespace
}  // namespace relume
