#include "techniques/features/edge_emission.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "render/session.h"
#include "scene/builtin.h"

namespace relume {
namespace {

RenderSettings settings_with(int edge_rays, int seed = 0) {
  RenderSettings s;
  s.width = 48;
  s.height = 48;
  s.threads = 1;
  s.seed = seed;
  s.path.max_bounces = 2;
  s.denoise = DenoiseChoice::svgf;
  s.features.edge_rays = edge_rays;
  return s;
}

View<const uint32_t> edges_of(const Session& session) { return session.buffers().view<const uint32_t>("edge-rays"); }

TEST(EmissionEdge, IsWhereNeighboursDifferByFarMoreThanItIsBright) {
  std::vector<float> emission(9, 0.0f);
  emission[0] = 10;
  const auto is_edge = [&](float scattered) {
    return is_emission_edge(
        1, 1, 3, 3, [&](uint32_t i) { return emission[i]; },
        [&](uint32_t i) { return emission[i] + (emission[i] > 0 ? 0.0f : scattered); });
  };
  EXPECT_TRUE(is_edge(1));
  EXPECT_FALSE(is_edge(3));
  emission.assign(9, 10);
  EXPECT_FALSE(is_edge(0));
  emission[4] = 0;  // the pixel itself has no say
  EXPECT_FALSE(is_edge(0));
}

TEST(EdgeEmission, FramesTheLampAndNothingElse) {
  Session session(find_builtin_scene("cornell")->build(), settings_with(16));
  session.render_frame();
  const auto emission = session.buffers().view<const Rgb>("feature-emission");
  int edges = 0;
  for (uint32_t i = 0; i < 48 * 48; ++i) {
    if (edges_of(session)[i] == 0) continue;
    ++edges;
    EXPECT_EQ(edges_of(session)[i], 16u);
    EXPECT_LT(i / 48, 16u) << "the lamp is at the top";
    EXPECT_LE(max_component(emission[i]), 17.01f);
  }
  EXPECT_GT(edges, 20);
  EXPECT_LT(edges, 160);
}

/// Mean and variance of a frame's radiance in the pixels that most frames take for edges.
struct Moments {
  double mean = 0;
  double variance = 0;  ///< of a pixel, averaged over pixels
};

Moments moments(const std::vector<uint32_t>& pixels, int edge_rays, EstimatorChoice estimator, int frames) {
  RenderSettings settings = settings_with(edge_rays, edge_rays + 1);
  settings.estimator = estimator;
  Session session(find_builtin_scene("cornell")->build(), settings);
  std::vector<double> sum(pixels.size(), 0);
  std::vector<double> squares(pixels.size(), 0);
  for (int frame = 0; frame < frames; ++frame) {
    session.render_frame();
    const auto radiance = session.buffers().view<const Rgb>("radiance");
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

TEST(EdgeEmission, TakesNoiseOutOfThePixelAndLeavesItsMean) {
  Session session(find_builtin_scene("cornell")->build(), settings_with(16));
  session.render_frame();
  std::vector<uint32_t> edges;
  for (uint32_t i = 0; i < 48 * 48; ++i) {
    if (edges_of(session)[i] > 0) edges.push_back(i);
  }
  for (const EstimatorChoice estimator : {EstimatorChoice::path, EstimatorChoice::bdpt}) {
    const int frames = 384;
    const Moments plain = moments(edges, 0, estimator, frames);
    const Moments measured = moments(edges, 16, estimator, frames);
    EXPECT_LT(measured.variance, plain.variance / 4);
    const double error = std::sqrt((plain.variance + measured.variance) / (frames * static_cast<double>(edges.size())));
    EXPECT_NEAR(measured.mean, plain.mean, 4 * error);
    EXPECT_LT(error, 0.01 * plain.mean);
  }
}

TEST(EdgeEmission, KeepsLampsSharpWhileTheCameraMoves) {
  const auto render = [](const RenderSettings& settings, int frames) {
    Session session(find_builtin_scene("cornell")->build(), settings);
    PlacedCamera camera = session.scene().camera();
    camera.to_world[3].x -= 0.02f * static_cast<float>(frames);
    for (int frame = 0; frame < frames; ++frame) {
      camera.to_world[3].x += 0.02f;
      session.set_camera(camera);
      session.render_frame();
    }
    return session.image();
  };
  RenderSettings still = settings_with(0);
  still.denoise = DenoiseChoice::none;
  Session reference(find_builtin_scene("cornell")->build(), still);
  for (int frame = 0; frame < 512; ++frame) reference.render_frame();
  const Image truth = reference.image();
  const auto error = [&](int edge_rays) {
    const Image picture = render(settings_with(edge_rays), 10);
    double sum = 0;
    for (size_t i = 0; i < 16 * 48; ++i) {
      const float off = luminance(picture.pixels[i]) - luminance(truth.pixels[i]);
      sum += static_cast<double>(off * off);
    }
    return sum;
  };
  EXPECT_LT(error(16), error(0) / 2);
}

}  // namespace
}  // namespace relume
