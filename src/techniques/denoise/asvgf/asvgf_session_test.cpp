// Tests A-SVGF in whole frames: false alarms, histories that end, and the lag behind changes of light.
#include <gtest/gtest.h>

#include <algorithm>
#include <iostream>
#include <stop_token>
#include <string>
#include <utility>

#include "builtin_scenes/builtin.h"
#include "builtin_scenes/shapes.h"
#include "files/testing/temp_folder.h"
#include "render/session.h"
#include "scene/testing/media.h"
#include "techniques/denoise/asvgf/asvgf_pass.h"

namespace relume {
namespace {

RenderSettings settings_of(DenoiseChoice denoise, int width, int height) {
  RenderSettings settings;
  settings.width = width;
  settings.height = height;
  settings.threads = 1;
  settings.denoise = denoise;
  return settings;
}

void shift_camera(Session& session, float distance) {
  CameraPose camera = session.camera();
  camera.to_world[3] += distance * camera.to_world[0];
  session.set_camera(camera);
}

/// Fraction of the pixels whose history was shortened in the last frame.
double shortened(const Session& session) {
  const View<const float> lambdas = buffer_table(session).read(kAsvgfLambda);
  EXPECT_GT(lambdas.size, 0u);
  size_t count = 0;
  for (const float lambda : lambdas) count += lambda > 0.0f ? 1 : 0;
  return static_cast<double>(count) / static_cast<double>(lambdas.size);
}

TEST(AsvgfSession, ChangesElsewhereCauseNoFalseAlarms) {
  // A plate moves outside the closed room, while the camera moves inside.
  Scene scene = find_builtin_scene("cornell-closed")->build();
  const auto node = static_cast<Index>(scene.nodes.size());
  testing::add_mesh(scene, testing::matte(Rgb(0.5f)), box({-1, 19, -1}, {1, 20, 1}));
  Session session(std::move(scene), settings_of(DenoiseChoice::asvgf, 72, 72), {node});
  double worst = 0;
  for (int frame = 0; frame < 8; ++frame) {
    if (frame > 0) {
      Transform transform;
      transform.translation = Vec3(0.1f * static_cast<float>(frame), 0, 0);
      session.set_transform(NodeHandle(node), transform);
      shift_camera(session, 0.02f);
    }
    session.render_frame();
    if (frame > 0) worst = std::max(worst, shortened(session));
  }
  EXPECT_LT(worst, 0.01);
}

TEST(AsvgfSession, CamerasThatMoveAloneTraceNoGradients) {
  for (const bool view_changes : {false, true}) {
    RenderSettings settings = settings_of(DenoiseChoice::asvgf, 48, 48);
    settings.asvgf.view_changes = view_changes;
    Session session(find_builtin_scene("cornell")->build(), settings);
    Session plain(find_builtin_scene("cornell")->build(), settings_of(DenoiseChoice::svgf, 48, 48));
    for (Session* s : {&session, &plain}) {
      s->render_frame();
      shift_camera(*s, 0.05f);
      s->render_frame();
    }
    EXPECT_EQ(session.statistics().rays > plain.statistics().rays, view_changes);
    EXPECT_EQ(shortened(session) > 0, view_changes);
  }
}

TEST(AsvgfSession, PathsThatCannotBeRepeatedHaveNoGradients) {
  const auto has_gradients = [](void (*change)(RenderSettings&)) {
    RenderSettings settings = settings_of(DenoiseChoice::asvgf, 16, 16);
    change(settings);
    Session session(find_builtin_scene("cornell")->build(), settings);
    session.render_frame();
    return buffer_table(session).find(kAsvgfLambda.name) != nullptr;
  };
  EXPECT_TRUE(has_gradients([](RenderSettings&) {}));
  EXPECT_TRUE(has_gradients([](RenderSettings& s) { s.lights = LightSelectionChoice::light_tree; }));
  EXPECT_FALSE(has_gradients([](RenderSettings& s) { s.lights = LightSelectionChoice::vlc; }));
  EXPECT_FALSE(has_gradients([](RenderSettings& s) { s.guide = GuideChoice::cdq; }));
  EXPECT_FALSE(has_gradients([](RenderSettings& s) { s.cache = CacheChoice::psf; }));
  EXPECT_FALSE(has_gradients([](RenderSettings& s) { s.reuse = ReuseChoice::ris; }));
  EXPECT_FALSE(has_gradients([](RenderSettings& s) { s.estimator = EstimatorChoice::bdpt; }));
}

TEST(AsvgfSession, DimmedLightShortensEveryHistory) {
  Scene scene = testing::plate(testing::matte(Rgb(0.5f)), 5, 1);
  scene.environment.kind = EnvironmentKind::constant;
  scene.environment.color = Rgb(1);
  Session session(std::move(scene), settings_of(DenoiseChoice::asvgf, 32, 32));
  for (int frame = 0; frame < 6; ++frame) session.render_frame();
  Environment dim;
  dim.kind = EnvironmentKind::constant;
  dim.color = Rgb(0.25f);
  session.set_environment(dim);
  session.render_frame();
  const View<const float> lambdas = buffer_table(session).read(kAsvgfLambda);
  for (const float lambda : lambdas) ASSERT_NEAR(lambda, 0.75f, 1e-4f);
}

TEST(AsvgfSession, StoppedAndResumedFramesHaveTheSameBits) {
  const TempFolder folder;
  const Scene scene = find_builtin_scene("turntable")->build();
  RenderSettings settings = settings_of(DenoiseChoice::asvgf, 53, 37);  // not a multiple of tiles or strata
  Session whole(scene, settings);
  Session resumed(scene, settings);
  settings.threads = 5;
  Session stopped(scene, settings);
  const auto render = [](Session& session, int frame) {
    session.set_time(0.1f * static_cast<float>(frame));
    session.render_frame();
  };
  constexpr int kStop = 3;
  for (int frame = 1; frame <= 6; ++frame) {
    if (frame == kStop) {
      std::stop_source stop;
      stopped.set_time(0.1f * kStop);
      stopped.on_pass([&stop](const std::string& pass) {
        if (pass == "asvgf-gradients") stop.request_stop();
      });
      EXPECT_FALSE(stopped.render_frame(stop.get_token()));
      stopped.on_pass(nullptr);
      whole.save_checkpoint(folder / "frames.ckpt");
      resumed.load_checkpoint(folder / "frames.ckpt");
    }
    for (Session* session : {&whole, &stopped}) render(*session, frame);
    if (frame >= kStop) render(resumed, frame);
  }
  EXPECT_GT(shortened(whole), 0.0);
  const Image image = whole.image();
  for (const Rgb& pixel : image.pixels) ASSERT_TRUE(is_finite(pixel));
  EXPECT_EQ(stopped.image().pixels, image.pixels);
  EXPECT_EQ(resumed.image().pixels, image.pixels);
}

double shown_mse(const Image& a, const Image& b) {
  double sum = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i)
    sum += static_cast<double>(length_squared(glm::min(a.pixels[i], Rgb(1)) - glm::min(b.pixels[i], Rgb(1)))) / 3.0;
  return sum / static_cast<double>(a.pixels.size());
}

constexpr int kWidth = 320;
constexpr int kHeight = 180;
constexpr float kFrameTime = 1.0f / 24;
constexpr int kMoving = 24;  ///< frames with moving lamps

/// Mean squared error after a second in which lamps move, and some frames after they have stopped.
struct Lag {
  double moving = 0;
  double stopped = 0;
};

Lag lag_of(RenderSettings settings, const Scene& scene, const Image& truth) {
  constexpr int kSeeds = 2;
  constexpr int kStopped = 4;
  Lag lag;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    settings.seed = seed;
    Session session(scene, settings);
    for (int frame = 1; frame <= kMoving; ++frame) {
      session.set_time(kFrameTime * static_cast<float>(frame));
      session.render_frame();
    }
    lag.moving += shown_mse(session.image(), truth) / kSeeds;
    for (int frame = 0; frame < kStopped; ++frame) session.render_frame();
    lag.stopped += shown_mse(session.image(), truth) / kSeeds;
  }
  return lag;
}

/// The scene after the lamps have moved, with 128 samples per pixel.
Image image_after_motion(const Scene& scene) {
  RenderSettings settings = settings_of(DenoiseChoice::none, kWidth, kHeight);
  settings.seed = 1001;
  settings.time_s = kFrameTime * kMoving;
  Session reference(scene, settings);
  for (int i = 0; i < 128; ++i) reference.render_frame();
  return reference.image();
}

void print(const char* scene, const char* denoiser, const Lag& lag) {
  std::cerr << scene << ", " << denoiser << ": MSE while lamps move " << lag.moving << ", four frames later "
            << lag.stopped << "\n";
}

class AsvgfLag : public ::testing::TestWithParam<const char*> {};

TEST_P(AsvgfLag, IsBelowThatOfSvgf) {
  const Scene scene = find_builtin_scene(GetParam())->build();
  const Image truth = image_after_motion(scene);
  const Lag blocks = lag_of(settings_of(DenoiseChoice::svgf, kWidth, kHeight), scene, truth);
  const Lag gradients = lag_of(settings_of(DenoiseChoice::asvgf, kWidth, kHeight), scene, truth);
  print(GetParam(), "svgf", blocks);
  print(GetParam(), "asvgf", gradients);
  EXPECT_LT(gradients.moving, blocks.moving);
  EXPECT_LT(gradients.stopped, blocks.stopped);
}

INSTANTIATE_TEST_SUITE_P(Slow, AsvgfLag, ::testing::Values("slit"),
                         [](const auto& instance) { return std::string(instance.param); });

/// In `turntable`, the filter of gradients averages brightening with darkening, and A-SVGF lags more than SVGF while
/// the lamp moves (README, Measured). The bounds are above the measured 1.63 and 1.03 times the MSE of SVGF. With one
/// level, A-SVGF lags less after the lamp has stopped.
TEST(SlowAsvgfTurntable, LagIsWithinTheStatedBound) {
  const Scene scene = find_builtin_scene("turntable")->build();
  const Image truth = image_after_motion(scene);
  RenderSettings settings = settings_of(DenoiseChoice::asvgf, kWidth, kHeight);
  const Lag blocks = lag_of(settings_of(DenoiseChoice::svgf, kWidth, kHeight), scene, truth);
  const Lag gradients = lag_of(settings, scene, truth);
  settings.asvgf.gradient_levels = 1;
  const Lag one_level = lag_of(settings, scene, truth);
  print("turntable", "svgf", blocks);
  print("turntable", "asvgf", gradients);
  print("turntable", "asvgf, one level", one_level);
  EXPECT_LT(gradients.moving, 2 * blocks.moving);
  EXPECT_LT(gradients.stopped, 1.2 * blocks.stopped);
  EXPECT_LT(one_level.moving, 1.2 * blocks.moving);
  EXPECT_LT(one_level.stopped, blocks.stopped);
}

}  // namespace
}  // namespace relume
