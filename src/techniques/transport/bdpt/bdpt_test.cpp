// Bidirectional path tracing and light tracing in scenes with known results.
#include "techniques/transport/bdpt/bdpt.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "builtin_scenes/builtin.h"
#include "files/testing/temp_folder.h"
#include "relume/error.h"
#include "render/build_pipeline.h"
#include "render/session.h"
#include "scene/testing/light_scene.h"
#include "scene/testing/media.h"
#include "techniques/transport/bdpt/testing/bdpt_frame.h"
#include "techniques/transport/bdpt/testing/zoo.h"

namespace relume::testing {
namespace {

static_assert(sizeof(PathVertex) <= 96);

Rgb mean_of(const std::vector<Rgb>& image) {
  glm::dvec3 sum(0);
  for (const Rgb& p : image) sum += glm::dvec3(p);
  return Rgb(sum / static_cast<double>(image.size()));
}

/// Number of rays of a complete bidirectional path tracer limited to D bounces, in a scene that loses no path: 2D + 1
/// along the subpaths and D(D + 3) / 2 for connections.
uint32_t all_rays(uint32_t bounces) { return 2 * bounces + 1 + bounces * (bounces + 3) / 2; }

TEST(Bdpt, CountsEveryRayOfAClosedSceneWithoutLoss) {
  for (uint32_t bounces = 0; bounces <= 6; ++bounces) {
    BdptFrame frame(make_closed_sphere(1.0f),
                    {.width = 32, .height = 32, .max_bounces = bounces, .russian_roulette = false});
    uint32_t complete = 0;
    for (uint32_t sample = 0; sample < 4; ++sample) {
      frame.run(1, sample);
      for (const uint32_t rays : frame.rays) {
        EXPECT_LE(rays, all_rays(bounces));
        complete += rays == all_rays(bounces) ? 1 : 0;
      }
    }
    // Two vertices on the same flat triangle of the sphere do not see each other. This concerns at most 27 connections
    // among 1280 triangles: 2 % of the samples.
    EXPECT_GT(complete, 4 * 32 * 32 * 97 / 100) << bounces << " bounces";
  }
}

TEST(Bdpt, TracesFewerRaysThanThePaperStates) {
  for (const char* scene : {"cornell", "cornell-closed", "cornell-glass", "corridor"}) {
    for (uint32_t bounces = 1; bounces <= 8; ++bounces) {
      BdptFrame frame(find_builtin_scene(scene)->build(), {.max_bounces = bounces, .russian_roulette = false});
      constexpr uint32_t kSamples = 4;
      double mean = 0;
      for (uint32_t sample = 0; sample < kSamples; ++sample) {
        frame.run(1, sample);
        for (const uint32_t rays : frame.rays) {
          EXPECT_LE(rays, all_rays(bounces));
          mean += static_cast<double>(rays) / static_cast<double>(kSamples * frame.rays.size());
        }
      }
      const double stated = bounces * bounces + 3 * bounces;  // [Sun20, §5.2.1]
      EXPECT_GT(mean, bounces) << scene << ", " << bounces << " bounces";
      // One bounce has up to 5 rays, not 4: three along the subpaths and two for connections.
      if (bounces > 1) {
        EXPECT_LT(mean, stated) << scene << ", " << bounces << " bounces";
      } else if (scene == std::string_view("cornell-closed")) {
        EXPECT_GT(mean, stated);
      }
    }
  }
}

/// L = e Σ ρ^k, k = 0 … D.
TEST(Bdpt, ClosedFurnaceAtEveryDepth) {
  constexpr float kAlbedo = 0.6f;
  for (const bool light_only : {false, true}) {
    double expected = 0;
    for (uint32_t bounces = 0; bounces <= 6; ++bounces) {
      expected += std::pow(static_cast<double>(kAlbedo), bounces);
      BdptOptions options{.max_bounces = bounces, .russian_roulette = bounces % 2 == 1, .light_only = light_only};
      const Rgb mean = mean_of(render_bdpt(make_closed_sphere(kAlbedo), options, 32));
      // 8192 samples with a standard deviation below the mean: five standard errors are 6 %, less by stratification.
      EXPECT_NEAR(static_cast<double>(mean.g) / expected, 1.0, 0.02)
          << bounces << " bounces, light only " << light_only;
    }
  }
}

TEST(Bdpt, LongPathsContinueFromTheCamera) {
  // An albedo of 0.9 puts a third of the light into paths of more than ten bounces.
  const Rgb expected = mean_of(render_bdpt(make_closed_sphere(0.9f), {.max_bounces = 64}, 32));
  EXPECT_NEAR(expected.g, 10.0f, 0.2f);
  for (const uint32_t vertices : {1u, 3u, kMaxLightVertices}) {
    const Rgb mean =
        mean_of(render_bdpt(make_closed_sphere(0.9f), {.max_bounces = 64, .max_light_vertices = vertices}, 32));
    EXPECT_NEAR(mean.g / expected.g, 1.0f, 0.02f) << vertices;
  }
}

TEST(Bdpt, ConnectionRouletteKeepsTheMeanAndSavesRays) {
  const auto measure = [](float roulette, double* rays) {
    BdptFrame frame(find_builtin_scene("cornell")->build(),
                    {.width = 24, .height = 24, .connection_roulette = roulette});
    Rgb sum(0);
    for (uint32_t sample = 0; sample < 96; ++sample) {
      frame.run(3, sample);
      for (size_t p = 0; p < frame.rays.size(); ++p) {
        sum += frame.radiance[p] / static_cast<float>(frame.rays.size());
        *rays += frame.rays[p];
      }
    }
    return sum;
  };
  double all = 0;
  double fewer = 0;
  const Rgb expected = measure(0, &all);
  const Rgb mean = measure(0.5f, &fewer);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean[c] / expected[c], 1.0f, 0.01f);
  EXPECT_LT(fewer, 0.9 * all);
}

TEST(Bdpt, BandsOfRowsChangeNothing) {
  const auto image = [](uint32_t rows) {
    BdptFrame frame(find_builtin_scene("cornell")->build(), {.width = 24, .height = 10, .max_light_vertices = 5});
    frame.run(3, 0, rows);
    return frame.radiance;
  };
  const std::vector<Rgb> expected = image(0);
  for (const uint32_t rows : {1u, 4u, 10u}) EXPECT_EQ(image(rows), expected) << rows;
}

TEST(Bdpt, SmallCameraConnectionsAreRarelyTested) {
  BdptFrame frame(make_closed_sphere(0.6f), {.connection_roulette = 0.5f});
  const BdptContext c = frame.context();
  LightVertexArrays arrays;
  LightVertices light = arrays.view();
  light.connections = 1;
  light.to_camera[0] = {.ray = {Vec3(0), Vec3(0, 0, 1), 1e-3f}, .contribution = Rgb(1), .raster = {3.5f, 2.5f}};
  constexpr int kSamples = 40000;
  const auto rays_a_sample = [&](float tested) {
    BdptCounters counters;
    for (uint32_t i = 0; i < kSamples; ++i) {
      light.to_camera[0].ray_id = hash(i);
      try_camera_connections(c, light, {tested}, counters);
    }
    return static_cast<double>(counters.rays) / kSamples;
  };
  const auto splat_a_sample = [&] {
    FixedPointRgb& splats = frame.splats[2 * frame.width() + 3];
    const double sum = static_cast<double>(splats.value().g);
    splats = {};
    return sum / kSamples;
  };
  EXPECT_EQ(rays_a_sample(0), 1);  // no connection tried before
  EXPECT_NEAR(splat_a_sample(), 1, 1e-3);
  EXPECT_NEAR(rays_a_sample(20), 0.1, 0.0075);  // a tenth of half of 20; five standard deviations
  EXPECT_NEAR(splat_a_sample(), 1, 0.075);
}

/// `samples`: per pixel.
void expect_three_rays_and_the_mean(const std::vector<const char*>& scenes, uint32_t samples) {
  for (const char* scene : scenes) {
    const auto measure = [&](float roulette, double* rays) {
      BdptFrame frame(find_builtin_scene(scene)->build(),
                      {.width = 24, .height = 24, .max_bounces = 1, .connection_roulette = roulette});
      glm::dvec3 sum(0);
      for (uint32_t sample = 0; sample < samples; ++sample) {
        frame.run(5, sample);
        for (size_t p = 0; p < frame.rays.size(); ++p) {
          sum += glm::dvec3(frame.radiance[p]) / static_cast<double>(samples * frame.rays.size());
          *rays = std::max(*rays, static_cast<double>(frame.rays[p]));
        }
      }
      return sum;
    };
    double all = 0;
    double fewer = 0;
    const glm::dvec3 expected = measure(0, &all);
    const glm::dvec3 mean = measure(0.25f, &fewer);
    EXPECT_EQ(all, 5) << scene;
    EXPECT_EQ(fewer, 3) << scene;
    for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(mean[channel] / expected[channel], 1, 0.01) << scene;
  }
}
TEST(Bdpt, OneBounceTakesThreeRaysAndKeepsTheMean) {
  expect_three_rays_and_the_mean({"cornell", "cornell-closed", "cornell-glass"}, 256);
}
// The slit is noisier.
TEST(SlowBdpt, OneBounceTakesThreeRaysAndKeepsTheMean) { expect_three_rays_and_the_mean({"slit"}, 2048); }

TEST(Bdpt, LightsInsideMediaUseTheirAbsorption) {
  BdptFrame frame(make_lamp_in_glass(), {});
  ASSERT_EQ(frame.light_medium.size(), 1u);
  for (const Rgb& medium : frame.light_medium) {
    EXPECT_NEAR(medium.r, -std::log(0.3f), 1e-4f);
    EXPECT_NEAR(medium.b, -std::log(0.5f), 1e-4f);
  }
  EXPECT_EQ(BdptFrame(find_builtin_scene("cornell-glass")->build(), {}).light_medium, std::vector<Rgb>(1, Rgb(0)));
  EXPECT_TRUE(BdptFrame(find_builtin_scene("cornell")->build(), {}).light_medium.empty());
}

TEST(Bdpt, LampsInDarkGlassAreAsBrightFromBothSides) {
  const Rgb camera_alone = mean_of(render_bdpt(make_lamp_in_glass(), {.max_light_vertices = 1}, 256));
  const Rgb both = mean_of(render_bdpt(make_lamp_in_glass(), {}, 256));
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(both[c] / camera_alone[c], 1.0f, 0.02f);  // 65536 samples each
}

TEST(Bdpt, CamerasInsideMediaUseTheirAbsorption) {
  const auto mean = [](const BdptOptions& options) {
    return mean_of(render_bdpt(make_lamp_in_glass(true), options, 512));
  };
  const Rgb both = mean({});
  const Rgb camera_alone = mean({.max_light_vertices = 1});
  const Rgb light_alone = mean({.light_only = true});
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(both[c] / camera_alone[c], 1.0f, 0.02f);
    EXPECT_NEAR(both[c] / light_alone[c], 1.0f, 0.02f);
  }
  EXPECT_NEAR(BdptFrame(make_lamp_in_glass(true), {}).compiled.view().camera_medium.r, -std::log(0.3f), 1e-4f);
  EXPECT_EQ(BdptFrame(make_lamp_in_glass(), {}).compiled.view().camera_medium, Rgb(0));
}

TEST(Bdpt, LampsHalfInsideAMediumKeepTheMean) {
  EXPECT_EQ(BdptFrame(make_lamp_half_in_glass(), {}).light_medium, std::vector<Rgb>(1, Rgb(kSeveralMedia)));
  const auto mean = [](const BdptOptions& options) {
    return mean_of(render_bdpt(make_lamp_half_in_glass(), options, 2048));
  };
  // With two bounces, paths also lead to the outer half, which camera subpaths alone reach too rarely.
  const Rgb one_bounce = mean({.max_bounces = 1, .max_light_vertices = 1});
  const Rgb two_bounces = mean({.max_bounces = 2});
  const Rgb light_once = mean({.max_bounces = 1, .light_only = true});
  const Rgb light_twice = mean({.max_bounces = 2, .light_only = true});
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(light_once[c] / one_bounce[c], 1.0f, 0.04f);
    EXPECT_NEAR(light_twice[c] / two_bounces[c], 1.0f, 0.04f);
  }
}

/// A plate and a ceiling with a half-transparent sheet between them. The lamp below the sheet shines up.
Scene make_sheet_below_ceiling() {
  Scene scene = plate(matte(Rgb(0.5f)), 3, 1);
  Material sheet = matte(Rgb(0));
  sheet.alpha_mode = AlphaMode::blend;
  sheet.alpha = 0.5f;
  sheet.double_sided = true;
  add_slab(scene, sheet, 1, 1);
  Material ceiling = matte(Rgb(0.8f));
  ceiling.double_sided = true;
  add_slab(scene, ceiling, 2, 2);
  add_light_node(scene, {"up", PunctualType::spot, Rgb(50), 0.5f, 0.6f}, Vec3(0, 0.6f, 0), Vec3(0, 2, 0.01f));
  return scene;
}

TEST(Bdpt, ShadowRaysDrawAlphaIndependently) {
  // All light passes the sheet twice, which leaves a quarter.
  Scene open = make_sheet_below_ceiling();
  open.materials[1].alpha = 0;
  const Rgb unhindered = mean_of(render_bdpt(std::move(open), {.max_bounces = 2}, 2048));
  for (const uint32_t vertices : {1u, 16u}) {
    const Rgb mean =
        mean_of(render_bdpt(make_sheet_below_ceiling(), {.max_bounces = 2, .max_light_vertices = vertices}, 2048));
    EXPECT_NEAR(mean.g / unhindered.g, 0.25f, 0.005f) << vertices;
  }
}

TEST(Bdpt, LightFromInfinityIsNotAbsorbedBeforeItIsSeen) {
  Scene scene = plate(matte(Rgb(0.5f)), 3, 1);
  add_slab(scene, tint(Rgb(0.5f, 1, 2)), 2, 2);
  Node& sheet = scene.nodes.back();
  sheet.transform.rotation = glm::angleAxis(kPi, Vec3(1, 0, 0));  // inner side up
  sheet.transform.translation.y = 4;
  PunctualLight sun{"sun", PunctualType::directional, Rgb(1)};
  sun.angular_diameter_rad = 0.5f;
  add_light_node(scene, sun, Vec3(0, 5, 0), Vec3(0, 0, 0.01f));
  const Rgb camera_alone = mean_of(render_bdpt(Scene(scene), {.max_light_vertices = 1}, 1024));
  const Rgb light_alone = mean_of(render_bdpt(Scene(scene), {.light_only = true}, 1024));
  EXPECT_GT(camera_alone.b, 0.05f);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(light_alone[c] / camera_alone[c], 1.0f, 0.03f);
}

TEST(Bdpt, LampsBroughtFromAfarShineFromTheirSurface) {
  // Mesh-space vertices are rounded to 0.5 mm there. The origin of the light must be offset by more than that.
  const auto mean = [](float away, const BdptOptions& options) {
    Scene scene = plate(matte(Rgb(0.5f)), 3, 1);
    Material lamp = matte(Rgb(0));
    lamp.emission = Rgb(10);
    add_slab(scene, lamp, 1, 1);
    const glm::quat turn = glm::angleAxis(0.7f, glm::normalize(Vec3(1, 2, 3)));
    const Vec3 shift(away, 0, 0);
    for (Vec3& p : scene.meshes.back().positions) p = glm::inverse(turn) * (Vec3(p.x, 1, -p.z)) + shift;
    Node& node = scene.nodes.back();
    node.transform.rotation = turn;
    node.transform.translation = -(turn * shift);
    BdptOptions moving = options;
    moving.movable = {static_cast<Index>(scene.nodes.size()) - 1};
    return mean_of(render_bdpt(std::move(scene), moving, 128));
  };
  const Rgb near = mean(0, {.light_only = true});
  EXPECT_GT(near.g, 0.5f);
  for (const float away : {5000.0f, -5000.0f}) {
    EXPECT_NEAR(mean(away, {.light_only = true}).g / near.g, 1.0f, 0.02f) << away;
    EXPECT_NEAR(mean(away, {.max_light_vertices = 1}).g / near.g, 1.0f, 0.02f) << away;
    EXPECT_NEAR(mean(away, {}).g / near.g, 1.0f, 0.02f) << away;
  }
}

TEST(Bdpt, DoesNotDependOnThreads) {
  for (const bool light_only : {false, true}) {
    BdptOptions options{.width = 40, .height = 40, .light_only = light_only};
    const std::vector<Rgb> one = render_bdpt(make_zoo(ZooLight::mixed, ZooCamera::thin_lens), options, 2);
    options.threads = 3;
    const std::vector<Rgb> three = render_bdpt(make_zoo(ZooLight::mixed, ZooCamera::thin_lens), options, 2);
    EXPECT_EQ(one, three);
  }
}

TEST(Bdpt, UnallocatedPixelsTraceNothing) {
  BdptFrame frame(find_builtin_scene("cornell")->build(), {});
  frame.allocation.assign(frame.hits.size(), 0);
  frame.allocation[37] = 1;
  frame.run(1, 0);
  for (size_t p = 0; p < frame.rays.size(); ++p) EXPECT_EQ(frame.rays[p] > 0, p == 37);
}

TEST(Bdpt, CountsSplatsThatAreTooBrightForTheirSums) {
  const auto lit = [](float brightness) {
    Scene scene = find_builtin_scene("cornell")->build();
    for (Material& material : scene.materials) material.emission *= brightness;
    return scene;
  };
  RenderSettings settings;
  settings.width = settings.height = 8;
  settings.threads = 1;
  for (const EstimatorChoice estimator : {EstimatorChoice::bdpt, EstimatorChoice::light, EstimatorChoice::vcm}) {
    settings.estimator = estimator;
    Session plain(lit(1), settings);
    plain.render_frame();
    EXPECT_TRUE(plain.warnings().empty());
    Session bright(lit(1e12f), settings);
    bright.render_frame();
    ASSERT_EQ(bright.warnings().size(), 1u);
    EXPECT_NE(bright.warnings()[0].find("brighter than 1048576 "), std::string::npos) << bright.warnings()[0];
    const TempFolder folder;
    bright.save_checkpoint(folder / "c.ckpt");
    Session resumed(lit(1e12f), settings);
    resumed.load_checkpoint(folder / "c.ckpt");
    EXPECT_EQ(resumed.warnings(), bright.warnings());
  }
}

TEST(Bdpt, CombinesWithBothMethodsOfReprojection) {
  RenderSettings settings;
  settings.history = HistoryChoice::reproject;
  for (const EstimatorChoice estimator : {EstimatorChoice::bdpt, EstimatorChoice::light, EstimatorChoice::vcm}) {
    settings.estimator = estimator;
    for (const ReprojectionMethod method : {ReprojectionMethod::forward, ReprojectionMethod::backward}) {
      settings.reproject.method = method;
      EXPECT_NO_THROW(plan(settings));
    }
  }
}

}  // namespace
}  // namespace relume::testing
