// Contract of every light: received and emitted samples follow their densities, and power() equals the emitted power.
#include "lights/light.h"

#include <gtest/gtest.h>

#include <set>

#include "scene/testing/light_scene.h"
#include "testing/histogram.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::DirectionChart;
using testing::Histogram;
using testing::LightScene;
using testing::NamedLight;
using testing::Random;

/// An environment with the sun as a separate light.
Environment sun_and_sky() {
  Environment e;
  e.kind = EnvironmentKind::sun_sky;
  e.sun_sky.sun_elevation_rad = 0.8f;
  return e;
}

/// All kinds of lights with every kind of environment.
const std::vector<LightScene>& light_scenes() {
  static const std::vector<LightScene> scenes = [] {
    std::vector<LightScene> list;
    list.push_back(testing::make_light_scene(testing::noise_environment(24, 12)));
    list.push_back(testing::make_light_scene(testing::constant_environment()));
    list.push_back(testing::make_light_scene(sun_and_sky()));
    return list;
  }();
  return scenes;
}

template <typename Check>
void for_each_light(const Check& check) {
  for (const LightScene& scene : light_scenes()) {
    for (const NamedLight& light : scene.named) check(scene.lights(), light.id, light.name);
  }
}

/// Intersection of a ray with a light's plane, if inside.
bool meet(const TriangleLight& t, const Vec3& p, const Vec3& w, EmitterPoint* point) {
  const glm::dvec3 e1(t.e1);
  const glm::dvec3 e2(t.e2);
  const glm::dvec3 h = glm::cross(glm::dvec3(w), e2);
  const double determinant = glm::dot(e1, h);
  if (determinant == 0.0) return false;
  const glm::dvec3 s = glm::dvec3(p) - glm::dvec3(t.v0);
  const glm::dvec3 q = glm::cross(s, e1);
  const double u = glm::dot(s, h) / determinant;
  const double v = glm::dot(glm::dvec3(w), q) / determinant;
  const double distance = glm::dot(e2, q) / determinant;
  point->barycentric = Vec2(static_cast<float>(u), static_cast<float>(v));
  point->position = t.position(point->barycentric);
  const bool inside = t.is_parallelogram ? u <= 1 && v <= 1 : u + v <= 1;
  return u >= 0 && v >= 0 && inside && distance > 0;
}

/// pdf_li as a function of direction alone.
double density_towards(const LightsView& view, LightId id, const Vec3& p, const Vec3& wi) {
  EmitterPoint on_light;
  const Light& light = view.lights[id];
  if (light.kind == LightKind::triangle && !meet(light.triangle, p, wi, &on_light)) return 0.0;
  return pdf_li(view, id, p, wi, on_light);
}

DirectionChart chart_towards(const Light& light, const Vec3& p) {
  if (light.kind == LightKind::triangle) {
    const Vec3 d = light.triangle.position(light.triangle.centre()) - p;
    return {make_frame(glm::normalize(d)), 0.5 * std::sqrt(light.triangle.area) / glm::length(d)};
  }
  if (light.kind == LightKind::directional) return {make_frame(light.directional.to_light), 0.0023};
  return {make_frame(glm::normalize(Vec3(0.2f, 0.9f, 0.3f))), 1.0};
}

TEST(Lights, ScenesHoldEveryKind) {
  std::set<LightKind> kinds;
  for_each_light([&](const LightsView& view, LightId id, const std::string&) { kinds.insert(view.lights[id].kind); });
  EXPECT_EQ(kinds.size(), size_t{kLightKindCount});
  for (const LightScene& scene : light_scenes()) {
    const bool has_sun = &scene == &light_scenes().back();
    ASSERT_EQ(scene.named.size(), has_sun ? 11u : 10u);
    EXPECT_TRUE(scene.lights().lights[1].triangle.two_sided);
    EXPECT_GE(scene.lights().lights[2].triangle.textured, 0);
    EXPECT_GE(scene.lights().lights[3].triangle.textured, 0);
    EXPECT_TRUE(scene.lights().lights[4].triangle.is_parallelogram);
    EXPECT_EQ(scene.lights().first_infinite, 7u);
  }
}

TEST(Lights, DirectionsFollowTheirDensity) {
  constexpr int kSamples = 40000;
  for_each_light([&](const LightsView& view, LightId id, const std::string& name) {
    for (const Vec3 p : {Vec3(0.1f, 0.2f, 0.3f), Vec3(-0.9f, 0.8f, 0.1f), Vec3(0.3f, 3.5f, -0.4f)}) {
      const DirectionChart chart = chart_towards(view.lights[id], p);
      Histogram histogram(14);
      Random random(61);
      bool any = false;
      for (int i = 0; i < kSamples; ++i) {
        const LightSample s = sample_li(view, id, p, random.next_2d());
        any = any || (s.pdf_w > 0.0f && !s.delta);
        if (s.delta) return;  // no density to test
        const Vec2 c = chart.coordinates(s.wi);
        if (s.pdf_w > 0.0f) {
          histogram.add(c.x, c.y);
        } else {
          histogram.add_outside();
        }
      }
      const bool is_surface = view.lights[id].kind == LightKind::triangle;
      const bool behind = p.y > 2.5f && is_surface && !view.lights[id].triangle.two_sided;
      EXPECT_EQ(any, !behind) << name;
      if (behind) continue;
      const auto pdf = [&](const Vec3& wi) { return density_towards(view, id, p, wi); };
      constexpr double kMaxStrays = 5e-5;  // outlines of lights cut bins, and quadrature misses slivers of them
      EXPECT_GT(histogram.test(chart.density(pdf), 7, 3, kMaxStrays).p_value, testing::significance())
          << name << " from " << p.x << ' ' << p.y;
    }
  });
}

TEST(Lights, SamplesAgreeWithTheirDensity) {
  for_each_light([&](const LightsView& view, LightId id, const std::string& name) {
    Random random(62);
    int mismatches = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p = random.point(1.0f);
      const LightSample s = sample_li(view, id, p, random.next_2d());
      if (!(s.pdf_w > 0.0f)) continue;
      ASSERT_NEAR(glm::length(s.wi), 1.0f, 1e-5f) << name;
      ASSERT_TRUE(is_finite(s.radiance)) << name;
      const float pdf = pdf_li(view, id, p, s.wi, {s.position, s.barycentric});
      if (s.delta) {
        ASSERT_EQ(pdf, 0.0f) << name;
        continue;
      }
      // Where densities jump (texels, rims), rounding may select the other side.
      if (std::fabs(pdf - s.pdf_w) > 1e-3f * s.pdf_w) ++mismatches;
      if (std::isfinite(s.distance)) {
        ASSERT_LT(glm::length(p + s.wi * s.distance - s.position), 1e-5f) << name;
      }
    }
    EXPECT_LE(mismatches, 4) << name;
  });
}

/// Compares the irradiance on an upward-facing plane at p, by light sampling, with brute-force integration over
/// directions.
TEST(Lights, IrradianceMatchesAnIntegralOverDirections) {
  const Vec3 p(0.1f, 0.2f, 0.3f);
  for_each_light([&](const LightsView& view, LightId id, const std::string& name) {
    const DirectionChart chart = chart_towards(view.lights[id], p);
    Random random(63);
    double sum = 0;
    double squares = 0;
    constexpr int kSamples = 200000;
    bool delta = false;
    for (int i = 0; i < kSamples; ++i) {
      const LightSample s = sample_li(view, id, p, random.next_2d());
      delta = delta || s.delta;
      const double value = s.valid() ? luminance(s.radiance) * std::fmax(0.0f, s.wi.y) / s.pdf_w : 0.0;
      sum += value / kSamples;
      squares += value * value / kSamples;
    }
    if (delta) return;
    const auto radiance = [&](const Vec3& wi) {
      if (wi.y <= 0.0f) return 0.0;
      const Light& l = view.lights[id];
      EmitterPoint point;
      if (l.kind == LightKind::triangle)
        return meet(l.triangle, p, wi, &point)
                   ? double(luminance(emitted_radiance(l.triangle, view.textured, point.barycentric, wi.y)) * wi.y)
                   : 0.0;
      return double(luminance(radiance_from_infinity(view, id, wi)) * wi.y);
    };
    const double exact = testing::integrate_square(chart.density(radiance), 32, 1e-3 * sum, 6);
    EXPECT_NEAR(sum, exact, 2e-3 * exact + 5 * std::sqrt(squares / kSamples)) << name;
  });
}

/// Irradiance / radiance from a polygon by Lambert's formula, which holds above the receiver's horizon.
double lambert(const std::vector<glm::dvec3>& corners, const glm::dvec3& n) {
  glm::dvec3 sum(0);
  for (size_t i = 0; i < corners.size(); ++i) {
    const glm::dvec3& a = corners[i];
    const glm::dvec3& b = corners[(i + 1) % corners.size()];
    const glm::dvec3 cross = glm::cross(a, b);
    sum += std::atan2(glm::length(cross), glm::dot(a, b)) * glm::normalize(cross);
  }
  return 0.5 * std::fabs(glm::dot(sum, n));
}

/// Mean of cos θ / pdf_w over an even grid of random numbers.
double sampled_irradiance(const TriangleLight& light, const Vec3& p, const Vec3& n) {
  constexpr int kGrid = 512;
  double sum = 0;
  for (int i = 0; i < kGrid * kGrid; ++i) {
    const Vec2 u((static_cast<float>(i % kGrid) + 0.5f) / kGrid, (static_cast<float>(i / kGrid) + 0.5f) / kGrid);
    const LightSample s = sample_li(light, TexturedEmission{}, p, u, kWideTriangle);
    if (s.pdf_w > 0.0f) sum += static_cast<double>(relume::max(glm::dot(n, s.wi), 0.0f) / s.pdf_w);
  }
  return sum / (kGrid * kGrid);
}

/// A lamp that faces −Z, at z = 0.
TriangleLight wide_lamp(bool is_parallelogram, float size) {
  TriangleLight light{};
  light.e1 = {size, 0, 0};
  light.e2 = {0, size, 0};
  light.normal = {0, 0, -1};
  light.area = size * size * (is_parallelogram ? 1.0f : 0.5f);
  light.width2 = 2.0f * size * size;
  light.radiance = Rgb(1);
  light.textured = -1;
  light.is_parallelogram = is_parallelogram;
  return light;
}

TEST(Lights, WideLampsGiveTheIrradianceOfTheirShape) {
  for (const bool is_parallelogram : {false, true}) {
    for (const float size : {0.01f, 1.0f, 300.0f}) {
      const TriangleLight light = wide_lamp(is_parallelogram, size);
      for (const float height : {0.003f, 0.01f, 0.1f, 1.0f, 3.0f}) {
        const Vec3 p = size * Vec3(0.3f, 0.3f, -height);
        ASSERT_TRUE(is_wide(light, light.v0 - p, kWideTriangle)) << height;
        std::vector<glm::dvec3> corners{light.v0 - p, light.v0 + light.e1 - p, light.v0 + light.e2 - p};
        if (is_parallelogram) corners.insert(corners.begin() + 2, light.position(Vec2(1)) - p);
        const double expected = lambert(corners, {0, 0, 1});
        EXPECT_NEAR(sampled_irradiance(light, p, {0, 0, 1}) / expected, 1.0, 2e-3) << size << ' ' << height;
      }
    }
  }
}

TEST(Lights, AreSampledByAreaNextToTheirPlane) {
  const TriangleLight light = wide_lamp(true, 2);
  const auto at_height = [&](float h) { return is_wide(light, light.v0 - Vec3(0.6f, 0.6f, -h), kWideTriangle); };
  EXPECT_TRUE(at_height(0.01f));
  EXPECT_FALSE(at_height(0.004f));
  EXPECT_FALSE(at_height(0.0f));
}

TEST(Lights, DeltaLightsFollowTheInverseSquare) {
  const LightsView& view = light_scenes()[0].lights();
  const PointLight& point = view.lights[5].point;
  for (const float d : {0.5f, 1.0f, 3.0f}) {
    const LightSample s = sample_li(view, 5, point.position - Vec3(0, d, 0), Vec2(0.5f));
    EXPECT_NEAR(s.radiance.r, 5.0f / (d * d), 1e-4f);
    EXPECT_FLOAT_EQ(s.wi.y, 1.0f);
  }
  const SpotLight& spot = view.lights[6].spot;
  const LightSample on_axis = sample_li(view, 6, spot.position + 2.0f * spot.axis, Vec2(0.5f));
  EXPECT_NEAR(on_axis.radiance.r, 5.0f / 4.0f, 1e-4f);
  const LightSample outside = sample_li(view, 6, spot.position - spot.axis, Vec2(0.5f));
  EXPECT_TRUE(is_black(outside.radiance));
  EXPECT_FALSE(sample_li(view, 5, point.position, Vec2(0.5f)).valid());  // at the light itself
}

/// Throughput of one emitted ray: radiance, intensity or irradiance over both densities.
Rgb emitted(const EmissionSample& s) { return s.valid() ? s.le * (s.cos_theta / (s.pdf_a * s.pdf_w)) : Rgb(0); }

TEST(Lights, PowerMatchesEmission) {
  for_each_light([&](const LightsView& view, LightId id, const std::string& name) {
    Random random(64);
    constexpr int kSamples = 100000;
    double sum = 0;
    double squares = 0;
    for (int i = 0; i < kSamples; ++i) {
      const Vec2 u = random.next_2d();
      const double value = luminance(emitted(sample_le(view, id, u, random.next_2d())));
      sum += value / kSamples;
      squares += value * value / kSamples;
    }
    const double exact = luminance(power(view, id));
    const double error = std::sqrt(std::max(0.0, squares - sum * sum) / kSamples);
    // Tabulated means of textures and maps are within half a percent.
    EXPECT_NEAR(sum, exact, 5e-3 * exact + 5 * error) << name;
  });
}

TEST(Lights, NarrowSpotsAreAsBrightAsStated) {
  for (const Vec2& cones : {Vec2(0, 0.002f), Vec2(0, 0.009f), Vec2(0.01f, 0.01f), Vec2(0.005f, 0.02f)}) {
    const SpotLight spot{.position = Vec3(0),
                         .axis = Vec3(0, 0, 1),
                         .intensity = Rgb(1),
                         .cos_inner = std::cos(cones.x),
                         .cos_outer = std::cos(cones.y)};
    EXPECT_FLOAT_EQ(sample_li(spot, Vec3(0, 0, 2)).radiance.r, 0.25f) << cones.y;
    Random random(67);
    constexpr int kSamples = 20000;
    double sum = 0;
    for (int i = 0; i < kSamples; ++i) sum += static_cast<double>(emitted(sample_le(spot, random.next_2d())).r);
    // The narrowest cone contains only thirty distinct float cosines.
    EXPECT_NEAR(sum / kSamples, power(spot).r, 0.05 * static_cast<double>(power(spot).r)) << cones.y;
  }
}

TEST(Lights, EmissionAgreesWithItsDensities) {
  for_each_light([&](const LightsView& view, LightId id, const std::string& name) {
    Random random(65);
    int mismatches = 0;
    for (int i = 0; i < 2000; ++i) {
      const Vec2 u = random.next_2d();
      const EmissionSample s = sample_le(view, id, u, random.next_2d());
      if (!s.valid()) continue;
      ASSERT_NEAR(glm::length(s.direction), 1.0f, 1e-5f) << name;
      EmitterPoint point{s.origin, Vec2(0)};
      const Light& light = view.lights[id];
      if (light.kind == LightKind::triangle) {
        ASSERT_NEAR(glm::dot(s.normal, s.direction), s.cos_theta, 1e-5f);
        ASSERT_TRUE(meet(light.triangle, s.origin - s.direction, s.direction, &point) || s.cos_theta < 0.05f) << name;
      }
      ASSERT_TRUE(!s.infinite || glm::length(s.origin - view.bounds.center) <= view.bounds.radius * 1.5f) << name;
      const EmissionPdf pdf = pdf_le(view, id, point, s.direction);
      if (std::fabs(pdf.pdf_w - (s.delta_direction ? 0.0f : s.pdf_w)) > 2e-3f * s.pdf_w) ++mismatches;
      if (std::fabs(pdf.pdf_a - (s.delta_position ? 0.0f : s.pdf_a)) > 2e-3f * s.pdf_a) ++mismatches;
    }
    EXPECT_LE(mismatches, 10) << name;
  });
}

TEST(Lights, EmittedDirectionsFollowTheirDensity) {
  for_each_light([&](const LightsView& view, LightId id, const std::string& name) {
    const Light& light = view.lights[id];
    DirectionChart chart = chart_towards(light, Vec3(0));
    if (light.kind == LightKind::triangle) chart = {make_frame(light.triangle.normal), 1.0};
    if (light.kind == LightKind::spot) chart = {make_frame(light.spot.axis), 0.3};
    if (light.kind == LightKind::directional) chart.frame = make_frame(-light.directional.to_light);
    Histogram histogram(14);
    Random random(66);
    EmitterPoint point;
    for (int i = 0; i < 40000; ++i) {
      const Vec2 u = random.next_2d();
      const EmissionSample s = sample_le(view, id, u, random.next_2d());
      if (s.delta_direction) return;
      const Vec2 c = chart.coordinates(s.direction);
      histogram.add(c.x, c.y);
      point.position = s.origin;
    }
    if (light.kind == LightKind::triangle) point = {light.triangle.position(Vec2(0.3f)), Vec2(0.3f)};
    const auto pdf = [&](const Vec3& w) { return double(pdf_le(view, id, point, w).pdf_w); };
    EXPECT_GT(histogram.test(chart.density(pdf), 7).p_value, testing::significance()) << name;
  });
}

TEST(Lights, EmittedPositionsFollowTheirDensity) {
  for_each_light([&](const LightsView& view, LightId id, const std::string& name) {
    const Light& light = view.lights[id];
    Histogram histogram(16);
    Random random(67);
    for (int i = 0; i < 40000; ++i) {
      const Vec2 u = random.next_2d();
      const EmissionSample s = sample_le(view, id, u, random.next_2d());
      if (s.delta_position) return;
      if (light.kind == LightKind::triangle) {
        EmitterPoint point;
        meet(light.triangle, s.origin - s.normal, s.normal, &point);
        histogram.add(point.barycentric.x, point.barycentric.y);
        continue;
      }
      const Vec3 local = make_frame(s.direction).to_local(s.origin - view.bounds.center) / view.bounds.radius;
      ASSERT_NEAR(local.z, -1.0f, 1e-4f) << name;
      histogram.add(0.5 * (local.x + 1), 0.5 * (local.y + 1));
    }
    const auto density = [&](double x, double y) -> double {
      if (light.kind != LightKind::triangle) return std::hypot(2 * x - 1, 2 * y - 1) < 1 ? 4.0 / M_PI : 0.0;
      const TriangleLight& t = light.triangle;
      if (!t.is_parallelogram && x + y > 1) return 0.0;
      const Vec2 b(static_cast<float>(x), static_cast<float>(y));
      const double cross = t.is_parallelogram ? t.area : 2.0 * t.area;
      return cross * pdf_le(view, id, {t.position(b), b}, t.normal).pdf_a;
    };
    EXPECT_GT(histogram.test(density, 7).p_value, testing::significance()) << name;
  });
}

}  // namespace
}  // namespace relume
