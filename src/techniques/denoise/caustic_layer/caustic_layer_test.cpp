#include "techniques/denoise/caustic_layer/caustic_layer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <utility>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "render/session.h"
#include "techniques/denoise/shared/denoiser_buffers.h"

namespace relume {
namespace {

constexpr EstimatorChoice kEstimators[] = {EstimatorChoice::bdpt, EstimatorChoice::light, EstimatorChoice::vcm};

RenderSettings settings_of(EstimatorChoice estimator, int size = 32) {
  RenderSettings settings;
  settings.width = settings.height = size;
  settings.threads = 1;
  settings.path.max_bounces = 4;
  settings.estimator = estimator;
  settings.vcm.radius = 0.02f;
  settings.bdpt.caustic_layer = true;
  settings.auxiliary = true;  // for the layer without a denoiser
  return settings;
}

Session rendered(const char* scene, const RenderSettings& settings, int frames) {
  Session session(find_builtin_scene(scene)->build(), settings);
  for (int i = 0; i < frames; ++i) session.render_frame();
  return session;
}

View<const Rgb> layer_of(const Session& session) { return buffer_table(session).read(kCausticMoments.mean); }

double mean_of(const View<const Rgb>& image) {
  double sum = 0;
  for (uint32_t i = 0; i < image.size; ++i) sum += static_cast<double>(luminance(image[i]));
  return sum / image.size;
}

double mean_of(const Image& image) { return mean_of(view_of(image.pixels)); }

TEST(CausticLayer, IsAPartOfTheImageAndLeavesItsBits) {
  for (const EstimatorChoice estimator : kEstimators) {
    for (const float limit : {0.0f, 4.0f}) {
      SCOPED_TRACE(::testing::Message() << static_cast<int>(estimator) << " limit " << limit);
      RenderSettings settings = settings_of(estimator);
      settings.firefly.limit = limit;
      const Session with = rendered("cornell-glass", settings, 4);
      settings.bdpt.caustic_layer = false;
      const Image image = with.image();
      EXPECT_EQ(image.pixels, rendered("cornell-glass", settings, 4).image().pixels);
      const View<const Rgb> layer = layer_of(with);
      ASSERT_EQ(layer.size, image.pixels.size());
      EXPECT_GT(mean_of(layer), 0.01 * mean_of(image));
      for (uint32_t i = 0; i < layer.size; ++i) {
        for (int c = 0; c < 3; ++c) {
          ASSERT_GE(layer[i][c], 0.0f) << i;
          ASSERT_LE(layer[i][c], 1.0001f * image.pixels[i][c] + 1e-5f) << i;
        }
      }
    }
  }
}

TEST(CausticLayer, HoldsAllLightOfLightTracingExceptDirectEmission) {
  RenderSettings settings = settings_of(EstimatorChoice::light);
  const Session session = rendered("cornell", settings, 4);
  const Image image = session.image();
  const View<const Rgb> layer = layer_of(session);
  settings.path.max_bounces = 0;
  const Image direct = rendered("cornell", settings, 4).image();
  EXPECT_GT(mean_of(direct), 0);
  for (uint32_t i = 0; i < layer.size; ++i) {
    for (int c = 0; c < 3; ++c) {
      const float rest = image.pixels[i][c] - layer[i][c];
      ASSERT_NEAR(rest, direct.pixels[i][c], 1e-4f * (1 + image.pixels[i][c])) << i;
    }
  }
}

/// Compares the layer with the splat image of adaptive sampling.
void expect_layer_of_splats(const char* scene, RenderSettings settings) {
  settings.allocation = AllocationChoice::adaptive;
  const Session session = rendered(scene, settings, 12);
  const View<const Rgb> layer = layer_of(session);
  const View<const Rgb> splats = buffer_table(session).read(kLightMean);
  ASSERT_EQ(layer.size, splats.size);
  EXPECT_GT(mean_of(layer), 0);
  for (uint32_t i = 0; i < layer.size; ++i) {
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(layer[i][c], splats[i][c], 1e-4f * (1 + splats[i][c])) << i;
  }
}

/// Without specular surfaces, no merged light is in the layer.
TEST(CausticLayer, EqualsTheSplatImageOfAdaptiveSampling) {
  for (const EstimatorChoice estimator : kEstimators) expect_layer_of_splats("cornell", settings_of(estimator));
}

/// Merged light is in cells.
TEST(CausticLayer, HoldsTheSplatsAloneWithACache) {
  for (const EstimatorChoice estimator : {EstimatorChoice::bdpt, EstimatorChoice::vcm}) {
    RenderSettings settings = settings_of(estimator);
    settings.cache = CacheChoice::psf;
    expect_layer_of_splats("cornell-glass", settings);
  }
}

TEST(CausticLayer, FollowsItsSurfacesUnderReprojection) {
  RenderSettings settings = settings_of(EstimatorChoice::bdpt);
  settings.history = HistoryChoice::reproject;
  settings.reproject.method = ReprojectionMethod::backward;
  Session session = rendered("cornell", settings, 4);
  CameraPose camera = session.camera();
  camera.to_world[3].x += 0.05f;
  session.set_camera(camera);
  session.render_frame();
  const View<const uint32_t> of_layer = buffer_table(session).read(kCausticMoments.samples);
  const View<const uint32_t> of_image = buffer_table(session).read(kSamples);
  uint32_t kept = 0;
  for (uint32_t i = 0; i < of_image.size; ++i) {
    EXPECT_GE(of_layer[i], of_image[i]) << i;  // that of one tap, and the least of all taps
    kept += of_layer[i] > 1 ? 1 : 0;
  }
  EXPECT_GT(kept, of_image.size / 2);
}

/// The variance of a frame's light, from the difference of two halves of the light paths, is that between frames.
TEST(CausticLayer, HalvesOfLightPathsShowTheNoise) {
  constexpr int kFrames = 256;
  RenderSettings settings = settings_of(EstimatorChoice::bdpt, 24);
  settings.stratify = false;
  Session session(find_builtin_scene("cornell")->build(), settings);
  std::vector<double> sums(24 * 24);
  std::vector<double> squares(sums.size());
  double estimated = 0;
  for (int frame = 0; frame < kFrames; ++frame) {
    session.render_frame();
    const View<const Rgb> radiance = buffer_table(session).read(kCausticRadiance);
    const View<const Rgb> difference = buffer_table(session).read(kCausticDifference);
    for (uint32_t i = 0; i < radiance.size; ++i) {
      const auto value = static_cast<double>(luminance(radiance[i]));
      sums[i] += value;
      squares[i] += value * value;
      estimated += static_cast<double>(sqr(luminance(difference[i]))) / kFrames;
    }
  }
  double measured = 0;
  for (size_t i = 0; i < sums.size(); ++i) measured += (squares[i] - sums[i] * sums[i] / kFrames) / (kFrames - 1);
  EXPECT_GT(measured, 0);
  EXPECT_NEAR(estimated / measured, 1.0, 0.1);
}

/// Sums over the filtered pixels of the layer.
struct FilterSums {
  double filtered = 0;          ///< light
  double unfiltered = 0;        ///< light
  double filtered_steps = 0;    ///< squared differences of neighbours in rows on surfaces of the same colour
  double unfiltered_steps = 0;  ///< the same
};

FilterSums sums_of(const Session& session, uint32_t width) {
  const BufferTable& buffers = buffer_table(session);
  const View<const Rgb> filtered = buffers.read(kFilteredCaustics);
  const View<const Rgb> unfiltered = buffers.read(kCausticMoments.mean);  // as in the filter's input: nothing moves
  const View<const Rgb> albedo = buffers.read(kFeatureAlbedo);
  FilterSums sums;
  for (uint32_t i = 0; i < filtered.size; ++i) {
    if (!is_filtered(albedo[i])) continue;
    sums.filtered += static_cast<double>(luminance(filtered[i]));
    sums.unfiltered += static_cast<double>(luminance(unfiltered[i]));
    if (i % width == 0 || albedo[i] != albedo[i - 1]) continue;
    sums.filtered_steps += static_cast<double>(sqr(luminance(filtered[i] - filtered[i - 1])));
    sums.unfiltered_steps += static_cast<double>(sqr(luminance(unfiltered[i] - unfiltered[i - 1])));
  }
  return sums;
}

/// Rare bright splats spread less than the darkness around them, so the first frames lose light.
TEST(CausticLayer, FilterRemovesNoiseAndKeepsTheMean) {
  constexpr uint32_t kSize = 32;
  for (const EstimatorChoice estimator : kEstimators) {
    SCOPED_TRACE(static_cast<int>(estimator));
    RenderSettings settings = settings_of(estimator, static_cast<int>(kSize));
    settings.denoise = DenoiseChoice::svgf;
    Session session = rendered("cornell", settings, 4);
    const FilterSums young = sums_of(session, kSize);
    EXPECT_LT(young.filtered_steps, 0.5 * young.unfiltered_steps);
    EXPECT_GT(young.filtered, 0.6 * young.unfiltered);
    EXPECT_LT(young.filtered, 1.05 * young.unfiltered);
    for (int i = 4; i < 64; ++i) session.render_frame();
    const FilterSums old = sums_of(session, kSize);
    EXPECT_NEAR(old.filtered / old.unfiltered, 1.0, 0.08);
  }
}

/// Without the layer, images of light tracing would be almost black; with it twice, twice as bright.
TEST(CausticLayer, EveryDenoiserAddsTheLayerOnce) {
  for (const DenoiseChoice denoise : {DenoiseChoice::bmfr, DenoiseChoice::svgf, DenoiseChoice::asvgf}) {
    RenderSettings settings = settings_of(EstimatorChoice::light);
    settings.denoise = denoise;
    const Session session = rendered("cornell", settings, 3);  // the image does not converge to the mean yet
    const View<const Rgb> mean = buffer_table(session).read(kMean);
    const View<const Rgb> albedo = buffer_table(session).read(kFeatureAlbedo);
    const Image image = session.image();
    double shown = 0;
    double expected = 0;
    for (uint32_t i = 0; i < mean.size; ++i) {
      if (!is_filtered(albedo[i])) continue;  // the lamp
      shown += static_cast<double>(luminance(image.pixels[i]));
      expected += static_cast<double>(luminance(mean[i]));
    }
    EXPECT_GT(shown, 0.75 * expected) << static_cast<int>(denoise);
    EXPECT_LT(shown, 1.1 * expected) << static_cast<int>(denoise);
  }
}

/// Sums of squared errors of denoised images where caustics are bright.
struct CausticErrors {
  double with = 0;
  double without = 0;
};

/// `reference`: pixels and caustic layer of an image with many samples.
CausticErrors errors_of(DenoiseChoice denoise, const Session& reference, int size) {
  constexpr int kFrames = 2;  // fewer than before images converge to the mean
  constexpr double kBright = 4;
  const Image exact = reference.image();
  const View<const Rgb> caustics = layer_of(reference);
  const double bright = kBright * mean_of(caustics);
  CausticErrors errors;
  int pixels = 0;
  for (int seed = 1; seed <= 6; ++seed) {
    for (const bool layer : {false, true}) {
      RenderSettings settings = settings_of(EstimatorChoice::bdpt, size);
      settings.auxiliary = false;
      settings.denoise = denoise;
      settings.bdpt.caustic_layer = layer;
      settings.seed = seed;
      const Image shown = rendered("cornell-glass", settings, kFrames).image();
      for (uint32_t i = 0; i < caustics.size; ++i) {
        if (static_cast<double>(luminance(caustics[i])) < bright) continue;
        const auto off = static_cast<double>(luminance(shown.pixels[i] - exact.pixels[i]));
        (layer ? errors.with : errors.without) += off * off;
        ++pixels;
      }
    }
  }
  EXPECT_GT(pixels, 12 * 8) << "too few bright pixels in each image";
  return errors;
}

TEST(CausticLayer, KeepsCausticsSharpInTheFirstFrames) {
  constexpr int kSize = 48;
  RenderSettings settings = settings_of(EstimatorChoice::bdpt, kSize);
  settings.seed = 100;
  const Session reference = rendered("cornell-glass", settings, 96);
  // The regression of BMFR already keeps caustics that rise above its noise, so it may gain less.
  constexpr std::pair<DenoiseChoice, double> kMost[] = {{DenoiseChoice::svgf, 1.0}, {DenoiseChoice::bmfr, 1.5}};
  for (const auto& [denoise, most] : kMost) {
    const CausticErrors errors = errors_of(denoise, reference, kSize);
    std::cerr << "denoiser " << static_cast<int>(denoise) << ": error with the layer " << errors.with << ", without "
              << errors.without << "\n";
    EXPECT_LT(errors.with, most * errors.without) << static_cast<int>(denoise);
  }
}

constexpr uint32_t kEdge = 16;
constexpr uint32_t kPixels = kEdge * kEdge;

/// A wall with a layer of equal light and noise.
struct LitWall {
  CausticPrepareKernel kernel() {
    CausticPrepareKernel k;
    k.position = view_of(position);
    k.normal = view_of(normal);
    k.albedo = view_of(albedo);
    k.depth = view_of(depth);
    k.light = view_of(light);
    k.noise = view_of(noise);
    k.count = view_of(count);
    k.features = {mutable_view_of(features), kEdge, kEdge};
    k.planes = {mutable_view_of(planes), kEdge, kEdge};
    k.cone_spread = 0.01f;
    k.width = k.height = kEdge;
    return k;
  }
  float plane(uint32_t c, uint32_t x, uint32_t y) {
    return *AtrousImage{mutable_view_of(planes), kEdge, kEdge}.at(c, x, y);
  }
  float valid(uint32_t x, uint32_t y) {
    return *AtrousImage{mutable_view_of(features), kEdge, kEdge}.at(place_of(AtrousPlane::valid), x, y);
  }

  std::vector<Vec3> position = std::vector<Vec3>(kPixels, Vec3(0));
  std::vector<Vec3> normal = std::vector<Vec3>(kPixels, Vec3(0, 0, 1));
  std::vector<Rgb> albedo = std::vector<Rgb>(kPixels, Rgb(1));
  std::vector<float> depth = std::vector<float>(kPixels, 1.0f);
  std::vector<Rgb> light = std::vector<Rgb>(kPixels, Rgb(3));
  std::vector<float> noise = std::vector<float>(kPixels, 0.5f);
  std::vector<uint32_t> count = std::vector<uint32_t>(kPixels, 2);
  std::vector<float> features = std::vector<float>(AtrousImage::size(kAtrousPlanes, kEdge, kEdge));
  std::vector<float> planes = std::vector<float>(AtrousImage::size(kAtrousChannels, kEdge, kEdge));
};

TEST(CausticPrepare, DividesTheNoiseOfAFrameByTheirNumber) {
  LitWall wall;
  wall.count[5 * kEdge + 5] = 10;
  wall.light[5 * kEdge + 6] = Rgb(300);  // contrast is no noise
  CausticPrepareKernel kernel = wall.kernel();
  kernel(5, 5);
  kernel(9, 9);
  EXPECT_FLOAT_EQ(wall.plane(kAtrousVariance, 5, 5), 0.05f);
  EXPECT_FLOAT_EQ(wall.plane(kAtrousVariance, 9, 9), 0.25f);
  EXPECT_EQ(wall.plane(1, 9, 9), 3.0f);
  kernel.correlated_frames = 4;
  kernel(5, 5);
  EXPECT_FLOAT_EQ(wall.plane(kAtrousVariance, 5, 5), 0.2f);
}

TEST(CausticPrepare, AveragesNoiseOverThePlane) {
  LitWall wall;
  wall.noise[8 * kEdge + 8] = 0;
  wall.noise[8 * kEdge + 9] = 1e6f;
  wall.normal[8 * kEdge + 9] = Vec3(1, 0, 0);
  wall.noise[9 * kEdge + 8] = 1e6f;
  wall.position[9 * kEdge + 8].z = 1;
  wall.noise[7 * kEdge + 8] = 1e6f;
  wall.albedo[7 * kEdge + 8] = Rgb(0);
  wall.noise[8 * kEdge + 7] = 1e6f;
  wall.count[8 * kEdge + 7] = 0;
  wall.kernel()(8, 8);
  EXPECT_FLOAT_EQ(wall.plane(kAtrousVariance, 8, 8), 0.5f * (20.0f / 21) / 2);  // 5 × 5 pixels without the four
}

TEST(CausticPrepare, PixelsWithoutSamplesTakeTheLightAround) {
  LitWall wall;
  wall.count[8 * kEdge + 8] = 0;
  wall.light[8 * kEdge + 8] = Rgb(0);
  wall.albedo[2] = Rgb(0);
  const CausticPrepareKernel kernel = wall.kernel();
  kernel(8, 8);
  kernel(2, 0);
  EXPECT_FLOAT_EQ(wall.plane(0, 8, 8), 3.0f);
  EXPECT_EQ(wall.valid(8, 8), 1.0f);
  EXPECT_EQ(wall.valid(2, 0), 0.0f);
}

TEST(CausticPresent, UnfilteredPixelsHaveNoSeparateLayer) {
  LitWall wall;
  wall.albedo[1] = Rgb(0);
  const CausticPrepareKernel prepare = wall.kernel();
  prepare(0, 0);
  prepare(1, 0);
  std::vector<Rgb> shown(kPixels, Rgb(9));
  const CausticPresentKernel present{view_of(wall.albedo), prepare.planes, mutable_view_of(shown), kEdge};
  present(0, 0);
  present(1, 0);
  EXPECT_EQ(shown[0], Rgb(3));
  EXPECT_EQ(shown[1], Rgb(0));
}

}  // namespace
}  // namespace relume
