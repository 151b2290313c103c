#include "techniques/reuse/reservoir/light_point.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "scene/testing/light_scene.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::LightScene;
using testing::Random;

LightScene scene_of_lights() { return testing::make_light_scene(testing::noise_environment(24, 12)); }

bool is_at_infinity(const LightsView& view, LightId light) { return light >= view.first_infinite; }

TEST(LightPoint, GivesTheSampleThatItWasTakenFrom) {
  const LightScene scene = scene_of_lights();
  const LightsView& view = scene.lights();
  Random random(1);
  for (const testing::NamedLight& named : scene.named) {
    int compared = 0;
    for (int n = 0; n < 500; ++n) {
      const Vec3 p(random.next() - 0.5f, 0.5f * random.next(), random.next() - 0.5f);
      const LightSample sample = sample_li(view, named.id, p, random.next_2d());
      if (!sample.valid()) continue;
      const LightSample again = light_at(view, point_of(view, named.id, sample), p);
      if (!again.valid()) continue;  // at the edge of the sun's disk
      ++compared;
      ASSERT_LT(glm::length(again.wi - sample.wi), 1e-5f) << named.name;
      ASSERT_EQ(again.delta, sample.delta) << named.name;
      if (!is_at_infinity(view, named.id)) {
        ASSERT_NEAR(again.distance, sample.distance, 1e-4f) << named.name;
      }
      for (int c = 0; c < 3; ++c)
        ASSERT_NEAR(again.radiance[c], sample.radiance[c], 1e-2f * std::fabs(sample.radiance[c]) + 1e-4f) << named.name;
    }
    EXPECT_GT(compared, 100) << named.name;
  }
}

/// The shift between receivers keeps the point: there and back is the identity, and so is its Jacobian.
TEST(LightPoint, StaysTheSameBetweenReceivers) {
  const LightScene scene = scene_of_lights();
  const LightsView& view = scene.lights();
  Random random(2);
  for (const testing::NamedLight& named : scene.named) {
    for (int n = 0; n < 300; ++n) {
      const Vec3 p(random.next() - 0.5f, 0.5f * random.next(), random.next() - 0.5f);
      const Vec3 q(random.next() - 0.5f, 0.5f * random.next(), random.next() - 0.5f);
      const LightSample sample = sample_li(view, named.id, p, random.next_2d());
      if (!sample.valid()) continue;
      const LightPoint point = point_of(view, named.id, sample);
      const LightSample there = light_at(view, point, q);
      if (!there.valid()) continue;
      const LightPoint back = point_of(view, named.id, there);
      EXPECT_EQ(back.light, point.light);
      EXPECT_LT(glm::length(back.coordinates - point.coordinates), 1e-5f) << named.name;
      // Steradians per unit of the coordinates change from p to q and back by factors whose product is one.
      const float forth = light_at(view, point, p).pdf_w / there.pdf_w;
      const float back_again = light_at(view, back, q).pdf_w / light_at(view, back, p).pdf_w;
      EXPECT_NEAR(forth * back_again, 1, 1e-4f) << named.name;
    }
  }
}

/// Points that are uniform in their coordinates give the irradiance that samples of the light give.
TEST(LightPoint, IntegratesOverItsCoordinates) {
  const LightScene scene = scene_of_lights();
  const LightsView& view = scene.lights();
  const Vec3 p(0.2f, 0.1f, -0.1f);
  Random random(3);
  constexpr int kSamples = 200000;
  for (const testing::NamedLight& named : scene.named) {
    const Light& light = view.lights[named.id];
    if (light.kind != LightKind::triangle || light.triangle.textured >= 0) continue;
    const bool parallelogram = light.triangle.is_parallelogram;
    double sums[2] = {};
    double squares[2] = {};
    for (int n = 0; n < kSamples; ++n) {
      const Vec2 u = random.next_2d();
      // The unit square, or the triangle of half its area.
      const LightPoint point{named.id, parallelogram ? u : triangle_from_square(u)};
      const LightSample samples[] = {light_at(view, point, p), sample_li(view, named.id, p, u)};
      const double area[] = {parallelogram ? 1.0 : 0.5, 1.0};
      for (int k = 0; k < 2; ++k) {
        if (!samples[k].valid()) continue;
        const double value = area[k] * static_cast<double>(luminance(samples[k].radiance) * std::fabs(samples[k].wi.y) /
                                                           samples[k].pdf_w);
        sums[k] += value / kSamples;
        squares[k] += value * value / kSamples;
      }
    }
    const double error =
        std::sqrt((squares[0] - sums[0] * sums[0] + squares[1] - sums[1] * sums[1]) / kSamples) + 1e-6 * sums[1];
    EXPECT_NEAR(sums[0], sums[1], 4.5 * error) << named.name;
    EXPECT_GT(sums[1], 0) << named.name;
  }
}

TEST(LightPoint, IsFoundByRays) {
  const LightScene scene = scene_of_lights();
  const LightsView& view = scene.lights();
  Random random(4);
  int found = 0;
  for (LightId id = 0; id < view.first_infinite; ++id) {
    if (view.lights[id].kind != LightKind::triangle || !view.lights[id].triangle.is_parallelogram) continue;
    for (int n = 0; n < 200; ++n) {
      const Vec3 p(random.next() - 0.5f, 0.5f * random.next(), random.next() - 0.5f);
      const LightSample sample = sample_li(view, id, p, random.next_2d());
      if (!sample.valid()) continue;
      ++found;
      // A hit has the barycentrics of its triangle, not those of the parallelogram.
      const LightPoint point = point_along(view, id, p, sample.wi, Vec2(0.25f));
      ASSERT_LT(glm::length(point.coordinates - sample.barycentric), 1e-3f);
      ASSERT_NEAR(density_of(view, id, p, light_at(view, point, p)) / sample.pdf_w, 1, 1e-2f);
    }
  }
  EXPECT_GT(found, 100);
}

}  // namespace
}  // namespace relume
