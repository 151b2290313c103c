// Tests rendered frames: lists find the lamps of a tile, follow changes, and keep the mean.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/builtin.h"
#include "builtin_scenes/shapes.h"
#include "render/session.h"
#include "techniques/reuse/restir_di/testing/over_seeds.h"

namespace relume {
namespace {

constexpr int kStalls = 8;

RenderSettings settings_of(LightSelectionChoice lights, float local = 0.65f) {
  RenderSettings settings;
  settings.width = 64;
  settings.height = 32;
  settings.threads = 1;
  settings.lights = lights;
  settings.neeat.local = local;
  settings.history = HistoryChoice::none;
  settings.path.max_bounces = 1;
  return settings;
}

/// Stalls of one metre between walls, seen from above, each with a lamp of its own; and `hidden` lamps of the same
/// power below the floor.
Scene stalls(int hidden) {
  SceneBuilder builder("stalls");
  const Index white = builder.add_material(matte("white", Rgb(0.7f)));
  const Index lamp = builder.add_material(emitter("lamp", Rgb(20)));
  builder.add("floor", quad({-20, 0, -20}, {0, 0, 40}, {40, 0, 0}), white);
  for (int i = 0; i <= kStalls; ++i) {
    const float x = static_cast<float>(i) - kStalls / 2.0f;
    builder.add("wall", box({x - 0.02f, 0, -2}, {x + 0.02f, 1.5f, 2}), white);
    if (i < kStalls) builder.add("lamp", quad({x + 0.45f, 0.9f, -0.05f}, {0.1f, 0, 0}, {0, 0, 0.1f}), lamp);
  }
  for (int i = 0; i < hidden; ++i) {
    const float x = 0.5f * static_cast<float>(i % 16) - 4;
    const float z = 0.5f * static_cast<float>(i / 16) - 2;
    builder.add("hidden", quad({x, -1, z}, {0.1f, 0, 0}, {0, 0, 0.1f}), lamp);
  }
  builder.add_camera({0, 8, 0.01f}, {0, 0, 0}, 28);
  return builder.take();
}

/// The stalls without hidden lamps, by many samples.
const Image& truth() {
  static const Image image = [] {
    RenderSettings settings = settings_of(LightSelectionChoice::light_tree);
    settings.history = HistoryChoice::accumulate;
    Session session(stalls(0), settings);
    for (int i = 0; i < 512; ++i) session.render_frame();
    return session.image();
  }();
  return image;
}

/// Squared error of single frames after `first` others, summed over pixels. Lamps face away from the camera, so their
/// edges add none.
double frame_error(const RenderSettings& settings, int first) {
  constexpr int kFrames = 16;
  Session session(stalls(96), settings);
  for (int i = 0; i < first; ++i) session.render_frame();
  double sum = 0;
  for (int i = 0; i < kFrames; ++i) {
    session.render_frame();
    const Image image = session.image();
    for (size_t p = 0; p < image.pixels.size(); ++p)
      for (int c = 0; c < 3; ++c) sum += sqr(static_cast<double>(image.pixels[p][c] - truth().pixels[p][c]));
  }
  return sum / kFrames;
}

/// Power gives the lamp of the stall one sample in 104. The use of all lights gives it about one in ten, and lists
/// about one in three: variances of 103, 9 and 2 times the squared mean. All pixels have found their lamp by then.
TEST(TileFrames, FindTheLampsOfATile) {
  double squared_mean = 0;
  for (const Rgb& c : truth().pixels) squared_mean += static_cast<double>(glm::dot(c, c));
  const double tiles = frame_error(settings_of(LightSelectionChoice::neeat), 64) / squared_mean;
  const double use = frame_error(settings_of(LightSelectionChoice::neeat, 0), 64) / squared_mean;
  const double power = frame_error(settings_of(LightSelectionChoice::power), 64) / squared_mean;
  EXPECT_LT(tiles, 2.6);
  EXPECT_LT(use, 14);
  EXPECT_GT(use, 3 * tiles);
  EXPECT_GT(power, 20 * tiles);
}

double mean_luminance(const Image& image) {
  double sum = 0;
  for (const Rgb& c : image.pixels) sum += static_cast<double>(luminance(c));
  return sum / static_cast<double>(image.pixels.size());
}

double mean_of_frames(Session& session, int frames) {
  double sum = 0;
  for (int i = 0; i < frames; ++i) {
    session.render_frame();
    sum += mean_luminance(session.image());
  }
  return sum / frames;
}

/// Lists adapted to one lamp do not lose the light of another that replaces it.
TEST(TileFrames, FollowChangedLights) {
  const auto swap = [](Session& session, bool second) {
    for (int i = 0; i < 2; ++i) {
      PunctualLight lamp{"lamp", PunctualType::point, Rgb((i == 1) == second ? 5.0f : 0.0f)};
      session.set_light(static_cast<Index>(i), lamp);
    }
  };
  Scene scene = stalls(0);
  for (const float x : {-1.5f, 2.5f}) {
    scene.lights.push_back({"lamp", PunctualType::point, Rgb(5)});
    Node node;
    node.transform.translation = {x, 1.2f, 0.4f};
    node.light = static_cast<Index>(scene.lights.size()) - 1;
    scene.add_node(node);
  }
  Session tiles(Scene(scene), settings_of(LightSelectionChoice::neeat));
  Session tree(Scene(scene), settings_of(LightSelectionChoice::light_tree));
  for (int i = 0; i < 6; ++i) {
    swap(tiles, i % 2 == 1);
    swap(tree, i % 2 == 1);
    for (int k = 0; k < 8; ++k) tiles.render_frame();
    // Standard errors are below 1 %. A lost lamp lacks most of the light.
    const double expected = mean_of_frames(tree, 128);
    EXPECT_NEAR(mean_of_frames(tiles, 128), expected, 0.06 * expected) << i;
  }
}

/// Moving surfaces and a moving camera, with all depths of paths.
TEST(TileFrames, KeepTheMeanInMotion) {
  const auto mean = [](LightSelectionChoice lights) {
    RenderSettings settings = settings_of(lights);
    settings.path.max_bounces = 4;
    Session session(find_builtin_scene("turntable")->build(), settings);
    const CameraPose start = session.camera();
    return testing::mean_over_seeds(32, [&](int seed) {
      session.restart(seed);
      CameraPose camera = start;
      double sum = 0;
      for (int frame = 0; frame < 8; ++frame) {
        session.set_time(0.1f * static_cast<float>(frame));
        camera.to_world[3] += 0.03f * camera.to_world[0];
        session.set_camera(camera);
        session.render_frame();
        sum += mean_luminance(session.image()) / 8;
      }
      return sum;
    });
  };
  const testing::Measured expected = mean(LightSelectionChoice::power);
  const testing::Measured tiles = mean(LightSelectionChoice::neeat);
  const double error = testing::error_of(tiles, expected);
  EXPECT_LT(error, 0.02 * expected.mean);
  EXPECT_NEAR(tiles.mean, expected.mean, 5 * error);
}

}  // namespace
}  // namespace relume
