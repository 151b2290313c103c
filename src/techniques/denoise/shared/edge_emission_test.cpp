#include "techniques/denoise/shared/edge_emission.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "render/session.h"
#include "techniques/denoise/shared/denoiser_buffers.h"

namespace relume {
namespace {

constexpr uint32_t kSize = 48;
constexpr uint32_t kPixels = kSize * kSize;

RenderSettings settings_with(int edge_rays, int seed = 0) {
  RenderSettings s;
  s.width = s.height = static_cast<int>(kSize);
  s.threads = 1;
  s.seed = seed;
  s.path.max_bounces = 2;
  s.denoise = DenoiseChoice::svgf;
  s.features.edge_rays = edge_rays;
  return s;
}

Session box(const RenderSettings& settings, const char* scene = "cornell") {
  return Session(find_builtin_scene(scene)->build(), settings);
}

std::vector<uint32_t> edges_of(Session& session) {
  const auto rays = buffer_table(session).view(kEdgeRays);
  std::vector<uint32_t> edges;
  for (uint32_t i = 0; i < kPixels; ++i) {
    if (rays[i] > 0) edges.push_back(i);
  }
  return edges;
}

TEST(EmissionEdge, IsWhereNeighboursDifferByFarMoreThanItIsBright) {
  std::vector<float> emission(9, 0.0f);
  const auto contrast = [&] { return emission_contrast(1, 1, 3, 3, [&](uint32_t i) { return emission[i]; }); };
  EXPECT_EQ(contrast(), 0);
  emission[4] = 10;  // the pixel itself does not count
  EXPECT_EQ(contrast(), 0);
  emission[0] = 7;
  EXPECT_EQ(contrast(), 7);
  EXPECT_EQ(darkest_around(1, 1, 3, 3, [&](uint32_t i) { return i == 4 ? 0.0f : 3.0f + emission[i]; }), 3);
  EXPECT_EQ(darkest_around(0, 0, 1, 1, [](uint32_t) { return 0.0f; }), kInfinity);  // no neighbours
}

TEST(EdgeEmission, LeavesTheCausticLayerOutOfScatteredLight) {
  std::vector<Rgb> radiance{Rgb(5), Rgb(7)};
  const std::vector<Rgb> emission(2, Rgb(1));
  const std::vector<Rgb> shown_emission(2, Rgb(2));
  const std::vector<uint32_t> edge_rays{0, 16};
  const std::vector<Rgb> caustics(2, Rgb(3));
  std::vector<Rgb> scattered(2);
  std::vector<uint32_t> rays(2);
  ReplaceEmissionKernel kernel;
  kernel.emission = view_of(emission);
  kernel.shown_emission = view_of(shown_emission);
  kernel.edge_rays = view_of(edge_rays);
  kernel.radiance = mutable_view_of(radiance);
  kernel.scattered = mutable_view_of(scattered);
  kernel.rays = mutable_view_of(rays);
  kernel.width = 2;
  kernel.caustics = view_of(caustics);
  kernel(0, 0);
  kernel(1, 0);
  EXPECT_EQ(scattered, (std::vector<Rgb>{Rgb(1), Rgb(3)}));
  EXPECT_EQ(radiance, (std::vector<Rgb>{Rgb(5), Rgb(8)})) << "the image keeps its caustics";
}

TEST(EdgeEmission, FramesTheLampAndNothingElse) {
  Session session = box(settings_with(16));
  session.render_frame();
  const auto emission = buffer_table(session).view(kShownEmission);
  const std::vector<uint32_t> edges = edges_of(session);
  EXPECT_GT(edges.size(), 20u);
  EXPECT_LT(edges.size(), 160u);
  int partly = 0;
  for (const uint32_t i : edges) {
    EXPECT_LT(i / kSize, 16u) << "the lamp is at the top";
    EXPECT_LE(max_component(emission[i]), 17.01f);
    partly += emission[i].r > 0.0f && emission[i].r < 16.9f ? 1 : 0;
  }
  EXPECT_GT(partly, 10);
}

/// Emission and edges after two frames.
struct Edges {
  std::vector<uint32_t> rays;
  std::vector<Rgb> shown;
  std::vector<Rgb> scattered;
  std::vector<Rgb> radiance;

  Edges(const char* scene, int edge_rays, bool scalar) {
    RenderSettings settings = settings_with(edge_rays);
    settings.width = 77;  // not a multiple of lanes or tiles
    settings.scalar_kernels = scalar;
    Session session = box(settings, scene);
    session.render_frame();
    session.render_frame();
    const BufferTable& buffers = buffer_table(session);
    rays = copy_of(buffers.view(kEdgeRays));
    shown = copy_of(buffers.view(kShownEmission));
    scattered = copy_of(buffers.view(kScattered));
    radiance = copy_of(buffers.view(kRadiance));
  }

  template <typename T>
  static std::vector<std::remove_const_t<T>> copy_of(const View<T>& view) {
    return {view.begin(), view.end()};
  }
};

TEST(EdgeEmission, FindsEdgesInLanesLikeInSinglePixels) {
  for (const char* scene : {"cornell", "furnace"}) {
    for (const int rays : {0, 4}) {
      SCOPED_TRACE(::testing::Message() << scene << " " << rays);
      const Edges single(scene, rays, true);
      const Edges lanes(scene, rays, false);
      EXPECT_EQ(single.rays, lanes.rays);
      EXPECT_EQ(single.shown, lanes.shown);
      EXPECT_EQ(single.scattered, lanes.scattered);
      EXPECT_EQ(single.radiance, lanes.radiance);
    }
  }
}

TEST(EdgeEmission, EdgesPersistUntilAChange) {
  Session session = box(settings_with(16));
  session.render_frame();
  size_t before = edges_of(session).size();
  for (int frame = 0; frame < 8; ++frame) {
    session.render_frame();
    const size_t now = edges_of(session).size();
    EXPECT_GE(now, before);
    before = now;
  }
  CameraPose camera = session.camera();
  camera.to_world[3].y -= 4.0f;  // below the floor: no lamp visible
  session.set_camera(camera);
  session.render_frame();
  EXPECT_LT(edges_of(session).size(), before);
}

/// Moments over frames of the radiance of some pixels, averaged over the pixels.
struct Moments {
  double mean = 0;
  double variance = 0;  ///< variance between frames
};

Moments moments(const std::vector<uint32_t>& pixels, const RenderSettings& settings, const char* scene, int frames) {
  Session session = box(settings, scene);
  std::vector<double> sum(pixels.size(), 0);
  std::vector<double> squares(pixels.size(), 0);
  for (int frame = 0; frame < frames; ++frame) {
    session.render_frame();
    const auto radiance = buffer_table(session).view(kRadiance);
    for (size_t k = 0; k < pixels.size(); ++k) {
      const auto value = static_cast<double>(luminance(radiance[pixels[k]]));
      sum[k] += value;
      squares[k] += value * value;
    }
  }
  Moments result;
  const auto n = static_cast<double>(frames);
  for (size_t k = 0; k < pixels.size(); ++k) {
    const double mean = sum[k] / n;
    result.mean += mean / static_cast<double>(pixels.size());
    result.variance += (squares[k] / n - mean * mean) / static_cast<double>(pixels.size());
  }
  return result;
}

struct Way {
  const char* name;
  const char* scene;
  void (*choose)(RenderSettings&);
};

class EdgeEmissionOf : public ::testing::TestWithParam<Way> {};

TEST_P(EdgeEmissionOf, RemovesNoiseAndKeepsTheMean) {
  const auto settings = [&](int edge_rays) {
    RenderSettings s = settings_with(edge_rays, edge_rays + 1);
    GetParam().choose(s);
    return s;
  };
  Session session = box(settings(16), GetParam().scene);
  session.render_frame();
  const std::vector<uint32_t> edges = edges_of(session);
  ASSERT_GT(edges.size(), 20u);
  const int frames = 192;
  const Moments plain = moments(edges, settings(0), GetParam().scene, frames);
  const Moments measured = moments(edges, settings(16), GetParam().scene, frames);
  EXPECT_LT(measured.variance, plain.variance / 3);
  const double error = std::sqrt((plain.variance + measured.variance) / (frames * static_cast<double>(edges.size())));
  EXPECT_NEAR(measured.mean, plain.mean, 4 * error);
  EXPECT_LT(error, 0.02 * plain.mean);
}

INSTANTIATE_TEST_SUITE_P(
    Ways, EdgeEmissionOf,
    ::testing::Values(Way{"path", "cornell", [](RenderSettings&) {}},
                      Way{"mirror", "cornell-mirror", [](RenderSettings&) {}},
                      Way{"bdpt", "cornell", [](RenderSettings& s) { s.estimator = EstimatorChoice::bdpt; }},
                      Way{"psf", "cornell", [](RenderSettings& s) { s.cache = CacheChoice::psf; }},
                      Way{"vlc", "cornell", [](RenderSettings& s) { s.lights = LightSelectionChoice::vlc; }}),
    [](const auto& way) { return std::string(way.param.name); });

/// Mean squared error of the upper third of the image, which contains the lamp.
double error_of(const Image& image, const Image& reference) {
  double sum = 0;
  for (size_t i = 0; i < 16 * kSize; ++i) {
    const float off = luminance(image.pixels[i]) - luminance(reference.pixels[i]);
    sum += static_cast<double>(off * off);
  }
  return sum / (16 * kSize);
}

Image reference_of_the_box() {
  RenderSettings settings = settings_with(0, 99);
  settings.denoise = DenoiseChoice::none;
  Session session = box(settings);
  for (int frame = 0; frame < 256; ++frame) session.render_frame();
  return session.image();
}

TEST(EdgeEmission, MeansOfStillImagesConvergeNoSlower) {
  const Image reference = reference_of_the_box();
  const auto error = [&](int edge_rays) {
    double sum = 0;
    for (int seed = 1; seed <= 8; ++seed) {
      Session session = box(settings_with(edge_rays, seed));
      for (int frame = 0; frame < 64; ++frame) session.render_frame();
      const auto mean = buffer_table(session).view(kMean);
      Image image(static_cast<int>(kSize), static_cast<int>(kSize));
      for (uint32_t i = 0; i < kPixels; ++i) image.pixels[i] = mean[i];
      sum += error_of(image, reference);
    }
    return sum;
  };
  EXPECT_LT(error(16), error(0));
}

TEST(EdgeEmission, KeepsLampsSharpWhileTheCameraMoves) {
  const Image reference = reference_of_the_box();
  const auto error = [&](int edge_rays) {
    const int frames = 10;
    Session session = box(settings_with(edge_rays));
    CameraPose camera = session.camera();
    camera.to_world[3].x -= 0.02f * static_cast<float>(frames);
    for (int frame = 0; frame < frames; ++frame) {
      camera.to_world[3].x += 0.02f;
      session.set_camera(camera);
      session.render_frame();
    }
    return error_of(session.image(), reference);
  };
  EXPECT_LT(error(16), error(0) / 2);
}

}  // namespace
}  // namespace relume
