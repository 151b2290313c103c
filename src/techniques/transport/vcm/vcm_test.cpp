// Vertex connection and merging in scenes with known results, and against path tracing and bidirectional path tracing.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/builtin.h"
#include "builtin_scenes/shapes.h"
#include "render/session.h"
#include "techniques/transport/bdpt/testing/image_mean.h"
#include "techniques/transport/bdpt/testing/zoo.h"

namespace relume::testing {
namespace {

RenderSettings settings_of(EstimatorChoice estimator, int size = 16) {
  RenderSettings settings;
  settings.width = settings.height = size;
  settings.threads = 1;
  settings.estimator = estimator;
  settings.history = HistoryChoice::none;  // each frame is an image, with the radius of the first
  return settings;
}

RenderSettings vcm_settings(float radius, int size = 16) {
  RenderSettings settings = settings_of(EstimatorChoice::vcm, size);
  settings.vcm.radius = radius;
  return settings;
}

/// Mean over the pixels of all frames, and its variance from the means of single frames.
ImageMean mean_of_frames(const Scene& scene, const RenderSettings& settings, int frames) {
  Session session(Scene(scene), settings);
  glm::dvec3 sum(0);
  glm::dvec3 squares(0);
  for (int i = 0; i < frames; ++i) {
    session.render_frame();
    const Image image = session.image();
    glm::dvec3 mean(0);
    for (const Rgb& p : image.pixels) mean += glm::dvec3(p) / static_cast<double>(image.pixels.size());
    sum += mean;
    squares += mean * mean;
  }
  EXPECT_EQ(session.statistics().nonfinite_samples, 0u);
  const double n = frames;
  return {sum / n, (squares / n - sum * sum / (n * n)) / n};
}

/// Expects equal means up to a relative bias.
void expect_close(const ImageMean& a, const ImageMean& b, double bias, const std::string& name) {
  constexpr double kStandardErrors = 5;
  for (int c = 0; c < 3; ++c) {
    const double noise = std::sqrt(a.variance[c] + b.variance[c]);
    EXPECT_LT(noise, 0.04 * b.value[c]) << name << ": too noisy to say anything";
    EXPECT_NEAR(a.value[c], b.value[c], kStandardErrors * noise + bias * b.value[c]) << name << ", channel " << c;
  }
}

constexpr float kPoolHeight = 2;       ///< of light and camera above the surface, metres
constexpr float kPoolDepth = 0.4f;     ///< of the floor below the surface, metres
constexpr float kPoolIor = 1.5f;       ///< of the block
constexpr float kPoolAlbedo = 0.8f;    ///< of the floor
constexpr float kPoolIntensity = 100;  ///< of the spotlight, W/sr
constexpr float kOuterAngle = 0.12f;   ///< of the spotlight's cone, radians

/// A diffuse floor in a block of smooth glass, seen from above through its surface. `x`: of the camera and its target.
SceneBuilder pool_seen_from(float x, float fov_y_deg) {
  SceneBuilder b("pool");
  b.add("block", box({-1, -0.5f, -1}, {1, 0, 1}), b.add_material(glass("block", kPoolIor)));
  b.add("floor", quad({-0.9f, -kPoolDepth, 0.9f}, {1.8f, 0, 0}, {0, 0, -1.8f}),
        b.add_material(matte("floor", Rgb(kPoolAlbedo))));
  b.add_camera({x, kPoolHeight, 0.2f}, {x, -kPoolDepth, 0}, fov_y_deg);
  return b;
}

/// The pool under a spotlight: no strategy but merging finds its light.
Scene pool_under_spotlight(float x, float fov_y_deg) {
  Scene scene = pool_seen_from(x, fov_y_deg).take();
  scene.lights.push_back({"spot", PunctualType::spot, Rgb(kPoolIntensity), 0.1f, kOuterAngle});
  Node node;
  node.transform = look_at({0.05f, kPoolHeight, 0}, {0, -kPoolDepth, 0});
  node.light = 0;
  scene.add_node(std::move(node));
  return scene;
}

/// The pool under a large lamp, which paths from the floor often hit.
Scene pool_under_lamp() {
  SceneBuilder b = pool_seen_from(0, 20);
  b.add("lamp", quad({-1, 2.5f, -1}, {2, 0, 0}, {0, 0, 2}), b.add_material(emitter("lamp", Rgb(5))));
  return b.take();
}

/// Radiance of the floor below the spotlight, from flux in small cones. The rays of a cone of angle θ reach the radius
/// θ (H + h / n) on the floor. Fresnel transmits T at normal incidence. Radiance that leaves the glass falls by n².
float expected_pool_radiance() {
  const float reflectance = sqr((kPoolIor - 1) / (kPoolIor + 1));
  const float irradiance = kPoolIntensity * (1 - reflectance) / sqr(kPoolHeight + kPoolDepth / kPoolIor);
  return kPoolAlbedo * kInvPi * irradiance * (1 - reflectance) / sqr(kPoolIor);
}

TEST(Vcm, FindsLightBelowGlassThatNoConnectionFinds) {
  const Scene scene = pool_under_spotlight(0, 3);
  RenderSettings settings = vcm_settings(0.02f, 32);
  settings.path.max_bounces = 3;
  const ImageMean mean = mean_of_frames(scene, settings, 128);
  const double expected = static_cast<double>(expected_pool_radiance());
  EXPECT_LT(std::sqrt(mean.variance.g), 0.01 * expected);
  EXPECT_NEAR(mean.value.g, expected, 0.03 * expected);
  for (const EstimatorChoice estimator : {EstimatorChoice::path, EstimatorChoice::bdpt}) {
    settings.estimator = estimator;
    EXPECT_EQ(mean_of_frames(scene, settings, 4).value.g, 0.0);
  }
}

/// Light subpaths reach the floor through the glass alone, so all merged light is in the caustic layer.
TEST(Vcm, LightBelowGlassIsInTheCausticLayer) {
  RenderSettings settings = vcm_settings(0.02f, 32);
  settings.path.max_bounces = 3;
  settings.bdpt.caustic_layer = true;
  settings.auxiliary = true;
  Session session(pool_under_spotlight(0, 3), settings);
  session.render_frame();
  const Image image = session.image();
  const View<const Rgb> layer = buffer_table(session).read(kCausticMoments.mean);
  double sum = 0;
  for (uint32_t i = 0; i < layer.size; ++i) {
    EXPECT_NEAR(layer[i].g, image.pixels[i].g, 1e-4f * image.pixels[i].g) << i;
    sum += static_cast<double>(layer[i].g);
  }
  EXPECT_GT(sum / layer.size, 0.5 * static_cast<double>(expected_pool_radiance()));
}

/// The square of the difference of two halves of the light paths estimates the variance that they cause. The glass
/// reflects some camera paths, which find no light: only frames with light count.
TEST(Vcm, HalvesOfLightPathsShowTheNoiseOfMergedLight) {
  constexpr int kFrames = 1024;
  constexpr uint32_t kPixels = 16 * 16;
  RenderSettings settings = vcm_settings(0.04f);  // about ten light paths reach each camera path
  settings.path.max_bounces = 3;
  settings.stratify = false;
  settings.bdpt.caustic_layer = true;
  settings.auxiliary = true;
  Session session(pool_under_spotlight(0, 3), settings);
  std::vector<double> counts(kPixels);
  std::vector<double> sums(kPixels);
  std::vector<double> squares(kPixels);
  std::vector<double> estimates(kPixels);
  for (int frame = 0; frame < kFrames; ++frame) {
    session.render_frame();
    const View<const Rgb> light = buffer_table(session).read(kCausticRadiance);
    const View<const Rgb> difference = buffer_table(session).read(kCausticDifference);
    for (uint32_t i = 0; i < kPixels; ++i) {
      if (!(light[i].g > 0.0f)) continue;
      const auto value = static_cast<double>(light[i].g);
      counts[i] += 1;
      sums[i] += value;
      squares[i] += value * value;
      estimates[i] += static_cast<double>(sqr(difference[i].g));
    }
  }
  double measured = 0;
  double estimated = 0;
  for (uint32_t i = 0; i < kPixels; ++i) {
    ASSERT_GT(counts[i], 0.8 * kFrames);
    measured += (squares[i] - sums[i] * sums[i] / counts[i]) / (counts[i] - 1);
    estimated += estimates[i] / counts[i];
  }
  EXPECT_NEAR(estimated / measured, 1.0, 0.15);  // four standard errors: the pixels share their light paths
}

TEST(Vcm, AgreesWithPathTracingBelowGlassUnderALargeLamp) {
  const Scene scene = pool_under_lamp();
  const ImageMean camera_alone = mean_of_frames(scene, settings_of(EstimatorChoice::path, 32), 192);
  expect_close(mean_of_frames(scene, vcm_settings(0.015f, 32), 96), camera_alone, 0.02, "pool");
}

TEST(Vcm, HasTheMeanOfBidirectionalPathTracingWithoutMerging) {
  for (const ZooCamera camera : {ZooCamera::pinhole, ZooCamera::thin_lens}) {
    const Scene scene = make_zoo(ZooLight::mixed, camera);
    const ImageMean bdpt = mean_of_frames(scene, settings_of(EstimatorChoice::bdpt), 96);
    for (const int pixels_per_path : {1, 3}) {
      RenderSettings settings = vcm_settings(0);
      settings.vcm.pixels_per_path = pixels_per_path;
      expect_same_mean(mean_of_frames(scene, settings, 96), bdpt, std::to_string(pixels_per_path) + " pixels");
    }
  }
}

/// Lights that paths from behind glass can hit, so that path tracing misses nothing.
constexpr ZooLight kLightsWithExtent[] = {ZooLight::triangles, ZooLight::two_sided, ZooLight::textured,
                                          ZooLight::sun_disk,  ZooLight::sun_sky,   ZooLight::environment_map};

void expect_mean_of_path_tracing(const Scene& scene, int pixels_per_path, int frames, const std::string& name) {
  RenderSettings settings = vcm_settings(0.01f);
  settings.vcm.pixels_per_path = pixels_per_path;
  const ImageMean camera_alone = mean_of_frames(scene, settings_of(EstimatorChoice::path), 2 * frames);
  expect_close(mean_of_frames(scene, settings, frames), camera_alone, 0.03, name);
}

TEST(Vcm, HasTheMeanOfBidirectionalPathTracingWithRandomConnections) {
  const Scene scene = make_zoo(ZooLight::mixed, ZooCamera::thin_lens);
  const ImageMean bdpt = mean_of_frames(scene, settings_of(EstimatorChoice::bdpt), 96);
  RenderSettings settings = vcm_settings(0);
  settings.vcm.connections = 2;
  expect_same_mean(mean_of_frames(scene, settings, 128), bdpt, "two connections");
}

TEST(Vcm, AgreesWithPathTracingAtASmallRadius) {
  expect_mean_of_path_tracing(make_zoo(ZooLight::triangles, ZooCamera::thin_lens), 1, 128, "triangles");
  expect_mean_of_path_tracing(make_zoo(ZooLight::environment_map, ZooCamera::pinhole), 2, 128, "environment");
}

TEST(SlowVcm, AgreesWithPathTracingWithAllLightsAndCameras) {
  for (const ZooLight light : kLightsWithExtent) {
    for (const ZooCamera camera : kZooCameras) {
      const std::string name =
          std::string(kZooLightNames[static_cast<int>(light)]) + " " + kZooCameraNames[static_cast<int>(camera)];
      expect_mean_of_path_tracing(make_zoo(light, camera), 1, 1024, name);
    }
  }
}

TEST(Vcm, AgreesOnColoursBehindDispersiveGlass) {
  expect_mean_of_path_tracing(dispersive(make_zoo(ZooLight::triangles, ZooCamera::pinhole), 10), 1, 192, "dispersion");
}

TEST(Vcm, AgreesInTintedMedia) { expect_mean_of_path_tracing(make_lamp_in_glass(), 1, 256, "lamp in glass"); }

/// L = e Σ ρ^k, k = 0 … D. A chord of length r cuts a cap of area π r² off a sphere, so merging has no bias here.
TEST(Vcm, ClosedFurnaceAtEveryDepth) {
  constexpr float kAlbedo = 0.6f;
  double expected = 0;
  for (int bounces = 0; bounces <= 4; ++bounces) {
    expected += std::pow(static_cast<double>(kAlbedo), bounces);
    RenderSettings settings = vcm_settings(0.1f);
    settings.path.max_bounces = bounces;
    settings.path.russian_roulette = bounces % 2 == 1;
    settings.bdpt.connection_roulette = 0;  // traces light subpaths with one bounce, too
    const ImageMean mean = mean_of_frames(make_closed_sphere(kAlbedo), settings, 32);
    EXPECT_NEAR(mean.value.g / expected, 1.0, 0.02) << bounces << " bounces";
  }
}

/// At primary hits, splats, mergings and connections find only direct light. Reservoirs add all other light.
TEST(Vcm, ClosedFurnaceWithReservoirsOfIndirectLight) {
  constexpr float kAlbedo = 0.6f;
  for (const ReuseChoice reuse : {ReuseChoice::restir_gi, ReuseChoice::restir_di_gi}) {
    double expected = 1 + static_cast<double>(kAlbedo);
    for (int bounces = 2; bounces <= 4; ++bounces) {
      expected += std::pow(static_cast<double>(kAlbedo), bounces);
      RenderSettings settings = vcm_settings(0.1f);
      settings.path.max_bounces = bounces;
      settings.path.russian_roulette = bounces % 2 == 1;
      settings.vcm.connections = bounces == 3 ? 2 : 0;
      settings.reuse = reuse;
      settings.restir.cap = settings.restir_gi.cap = 4;
      const ImageMean mean = mean_of_frames(make_closed_sphere(kAlbedo), settings, 32);
      EXPECT_NEAR(mean.value.g / expected, 1.0, 0.02) << bounces << " bounces";
    }
  }
}

/// Green mean of an image over many frames, beside the cone of light: the blur of merging.
double blur_beside_the_light(float alpha) {
  constexpr float kEdge = kOuterAngle * (kPoolHeight + kPoolDepth / kPoolIor);
  RenderSettings settings = vcm_settings(0.06f);
  settings.history = HistoryChoice::accumulate;
  settings.path.max_bounces = 3;
  settings.vcm.alpha = alpha;
  Session session(pool_under_spotlight(kEdge + 0.05f, 1), settings);
  for (int i = 0; i < 64; ++i) session.render_frame();
  double sum = 0;
  for (const Rgb& p : session.image().pixels) sum += static_cast<double>(p.g);
  return sum / static_cast<double>(session.image().pixels.size());
}

TEST(Vcm, ShrinkingRadiiReduceTheBlur) {
  const double constant = blur_beside_the_light(1);
  EXPECT_GT(constant, 0.002 * static_cast<double>(expected_pool_radiance()));
  EXPECT_LT(blur_beside_the_light(0.25f), 0.3 * constant);
}

double statistic(const Session& session, std::string_view name) {
  for (const PassStatistic& s : session.statistics().pass_statistics) {
    if (s.name.ends_with(name)) return s.value;
  }
  ADD_FAILURE() << "no statistic " << name;
  return 0;
}

TEST(Vcm, TracesFewerLightPathsWhereMemoryIsShort) {
  const Scene scene = find_builtin_scene("cornell")->build();
  constexpr int kSize = 64;
  RenderSettings settings = vcm_settings(0.01f, kSize);
  settings.vcm.memory_mib = 1;
  Session limited{Scene(scene), settings};
  Session without{Scene(scene), settings_of(EstimatorChoice::bdpt, kSize)};
  for (int i = 0; i < 4; ++i) {
    limited.render_frame();
    without.render_frame();
    EXPECT_LE(limited.statistics().technique_bytes, without.statistics().technique_bytes + (size_t{1} << 20));
  }
  EXPECT_LT(statistic(limited, "light-paths"), 0.5 * kSize * kSize);
  EXPECT_GT(statistic(limited, "light-paths"), 100);
  EXPECT_GT(statistic(limited, "merging-vertices"), 100);
  expect_close(mean_of_frames(scene, settings, 24),
               mean_of_frames(scene, settings_of(EstimatorChoice::bdpt, kSize), 24), 0.02, "cornell");
}

/// Dithered light subpaths would repeat with the tile.
TEST(Vcm, DoesNotDitherLightSubpaths) {
  const auto vertices = [](bool dither) {
    RenderSettings settings = vcm_settings(0.03f, 40);
    settings.dither = dither;
    Session session(find_builtin_scene("cornell")->build(), settings);
    session.render_frame();
    return statistic(session, "merging-vertices");
  };
  EXPECT_GT(vertices(true), 1000);
  EXPECT_EQ(vertices(true), vertices(false));
}

TEST(Vcm, HasTheSameBitsWithAnyThreadsAndForms) {
  const auto image = [](int threads, bool scalar_kernels) {
    RenderSettings settings = vcm_settings(0.03f, 40);
    settings.history = HistoryChoice::accumulate;
    settings.accel = AccelChoice::bvh;
    settings.threads = threads;
    settings.scalar_kernels = scalar_kernels;
    Session session(find_builtin_scene("cornell-glass")->build(), settings);
    for (int i = 0; i < 3; ++i) session.render_frame();
    EXPECT_GT(statistic(session, "merging-vertices"), 1000);
    return session.image().pixels;
  };
  const std::vector<Rgb> one = image(1, false);
  EXPECT_EQ(image(5, false), one);
  EXPECT_EQ(image(5, true), one);
}

}  // namespace
}  // namespace relume::testing
