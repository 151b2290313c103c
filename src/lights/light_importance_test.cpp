#include "lights/light_importance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "materials/make_bsdf.h"
#include "scene/testing/light_scene.h"
#include "testing/random.h"

namespace relume {
namespace {

Bsdf surface(float roughness, float metallic, float cos_theta) {
  MaterialSample m;
  m.base_color = Rgb(0.8f);
  m.roughness = roughness;
  m.metallic = metallic;
  Bsdf bsdf;
  make_bsdf(bsdf, m, MaterialData{}, energy_tables(), cos_theta, true);
  return bsdf;
}

struct Receiver {
  Vec3 position;
  Frame frame;
  Vec3 wo_local;
  Bsdf bsdf;

  LightReceiver seen() const { return make_light_receiver(ltc_table(), position, frame, wo_local, bsdf); }
};

Receiver receiver(const Vec3& position, float roughness, float metallic, testing::Random& random) {
  Receiver r{position, make_frame(glm::normalize(Vec3(0, 1, 0) + 0.3f * random.direction())), Vec3(0), {}};
  const float cos_theta = 0.2f + 0.75f * random.next();
  const float sin_theta = std::sqrt(1 - cos_theta * cos_theta);
  const float phi = 2 * kPi * random.next();
  r.wo_local = {sin_theta * std::cos(phi), sin_theta * std::sin(phi), cos_theta};
  r.bsdf = surface(roughness, metallic, cos_theta);
  return r;
}

/// Reflected luminance of the light, estimated by sampling it.
double reflected(const LightsView& lights, LightId id, const Receiver& r, int samples) {
  testing::Random random(9);
  double sum = 0;
  for (int i = 0; i < samples; ++i) {
    const LightSample s = sample_li(lights, id, r.position, random.next_2d());
    if (!s.valid()) continue;
    const Vec3 wi = r.frame.to_local(s.wi);
    sum += static_cast<double>(luminance(eval_pdf(r.bsdf, r.wo_local, wi).f * s.radiance) * std::fabs(wi.z) / s.pdf_w);
  }
  return sum / samples;
}

/// Ratio of a sun's importance to the light that it reflects, for surfaces that face it.
TEST(InfiniteImportance, IsNearTheReflectedLightOfSuns) {
  const testing::LightScene scene = testing::make_light_scene({});
  const LightsView& lights = scene.lights();
  testing::Random random(4);
  int compared = 0;
  for (LightId id = lights.first_infinite; id < lights.lights.size; ++id) {
    if (lights.lights[id].kind != LightKind::directional) continue;
    for (int i = 0; i < 40; ++i) {
      const Receiver r = receiver(Vec3(0), 0.8f, 0.0f, random);
      if (r.frame.to_local(lights.lights[id].directional.to_light).z < 0.3f) continue;
      const double ratio = double{infinite_importance(r.seen(), lights, id)} / reflected(lights, id, r, 64);
      EXPECT_GT(ratio, 0.6) << id;
      EXPECT_LT(ratio, 1.6) << id;
      ++compared;
    }
  }
  EXPECT_GT(compared, 20);
}

TEST(InfiniteImportance, FadesAtTheHorizon) {
  EXPECT_EQ(soft_height(0.5f, 0.1f), 0.5f);
  EXPECT_FLOAT_EQ(soft_height(0.1f, 0.1f), 0.1f);
  EXPECT_GT(soft_height(-0.05f, 0.1f), 0.0f);  // half of the disk is visible
  EXPECT_EQ(soft_height(-0.1f, 0.1f), 0.0f);
  EXPECT_EQ(soft_height(-0.1f, 0.0f), 0.0f);
}

class LightImportance : public ::testing::Test {
 protected:
  const testing::LightScene scene_ = testing::make_light_scene({});
  const std::vector<CompactLight> list_ = compact_lights(scene_.lights());
  const View<const CompactLight> compact_ = view_of(list_);
};

TEST_F(LightImportance, MatchesMatteReflection) {
  testing::Random random(1);
  int lit = 0;
  for (int i = 0; i < 40; ++i) {
    Receiver r = receiver(Vec3(2.0f * random.next() - 1.0f, 0.2f * random.next(), random.next() - 0.5f), 1, 0, random);
    MaterialSample matte;
    matte.specular = 0;
    make_bsdf(r.bsdf, matte, MaterialData{}, energy_tables(), r.wo_local.z, true);
    for (LightId id = 0; id < scene_.lights().first_infinite; ++id) {
      if (id == 2 || id == 3) continue;  // textured: importance uses the texture's mean
      const double expected = reflected(scene_.lights(), id, r, 4000);
      // A softened point is exact in the limit of small lights. The width of these is half their distance.
      const bool has_extent = scene_.lights().lights[id].kind == LightKind::triangle;
      const double tolerance = has_extent ? 0.05 : 1e-3;
      EXPECT_NEAR(light_importance_of(r.seen(), scene_.lights(), compact_, id), expected, tolerance * expected + 1e-5)
          << scene_.named[id].name;
      lit += expected > 0;
    }
  }
  EXPECT_GT(lit, 100);
}

TEST_F(LightImportance, ApproximatesGlossyReflection) {
  testing::Random random(2);
  double worst = 1;
  double log_sum = 0;
  int count = 0;
  for (const float roughness : {0.4f, 0.6f, 0.8f}) {
    for (int i = 0; i < 30; ++i) {
      const Receiver r = receiver(Vec3(2.0f * random.next() - 1.0f, 0.3f, random.next() - 0.5f), roughness, 1, random);
      for (LightId id = 0; id < 2; ++id) {
        const double expected = reflected(scene_.lights(), id, r, 2000);
        if (expected < 1e-3) continue;
        const double ratio =
            static_cast<double>(light_importance_of(r.seen(), scene_.lights(), compact_, id)) / expected;
        worst = std::max({worst, ratio, 1 / ratio});
        log_sum += std::fabs(std::log(ratio));
        ++count;
      }
    }
  }
  // GGX has longer tails than a cosine, so single ratios may be off; most are not.
  EXPECT_LT(worst, 8.0);
  EXPECT_LT(log_sum / count, 0.35);
}

TEST_F(LightImportance, IsZeroBehindOneSidedTriangles) {
  testing::Random random(3);
  const Receiver above = receiver(Vec3(-1.8f, 2.6f, 0), 1, 0, random);  // over the first triangle, which emits down
  Receiver turned = above;
  turned.frame = make_frame(Vec3(0, -1, 0));
  EXPECT_EQ(light_importance_of(turned.seen(), scene_.lights(), compact_, 0), 0.0f);
  turned.position.x += 1.2f;  // over the two-sided one
  EXPECT_GT(light_importance_of(turned.seen(), scene_.lights(), compact_, 1), 0.0f);
}

TEST_F(LightImportance, BatchMatchesSingleLights) {
  testing::Random random(4);
  for (int i = 0; i < 50; ++i) {
    const Receiver r = receiver(random.point(1), random.next(), random.next() < 0.5f ? 0.0f : 1.0f, random);
    std::vector<LightId> ids;
    for (int k = 0; k < 29; ++k)
      ids.push_back(static_cast<LightId>(random.next() * static_cast<float>(scene_.lights().first_infinite)));
    for (uint32_t count = 0; count <= ids.size(); count += 7) {
      std::vector<float> weights(ids.size() + 1, -1.0f);
      const float sum = light_importances(r.seen(), scene_.lights(), compact_, ids.data(), count, weights.data());
      float expected = 0;
      for (uint32_t k = 0; k < count; ++k) {
        ASSERT_EQ(weights[k], light_importance_of(r.seen(), scene_.lights(), compact_, ids[k]));
        expected += weights[k];
      }
      EXPECT_EQ(sum, expected);
      EXPECT_EQ(weights[count], -1.0f);  // no write past the end
    }
  }
}

TEST_F(LightImportance, SeesThroughThinWalls) {
  testing::Random random(5);
  MaterialSample m;
  m.transmission = 1;
  m.roughness = 0.5f;
  Receiver r{Vec3(-1.8f, 0.5f, 0), make_frame(Vec3(0, -1, 0)), Vec3(0, 0, 1), {}};
  make_bsdf(r.bsdf, m, MaterialData{}, energy_tables(), 1, true);
  EXPECT_GT(light_importance_of(r.seen(), scene_.lights(), compact_, 0), 0.0f);  // the lamp is on the other side
  EXPECT_GT(light_importance_of(r.seen(), scene_.lights(), compact_, 4), 0.0f);
}

}  // namespace
}  // namespace relume
