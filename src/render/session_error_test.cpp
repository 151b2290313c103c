// Sessions after errors of launches, as of a device that fails.
#include <functional>
#include <limits>
#include <new>
#include <stop_token>
#include <string>
#include <string_view>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "relume/error.h"
#include "render/session.h"
#include "scene/testing/figure.h"
#include "scene/testing/light_scene.h"
#include "testing/failing_memory.h"

namespace relume {
namespace {

RenderSettings small_settings() {
  RenderSettings settings;
  settings.width = 16;
  settings.height = 12;
  settings.threads = 2;
  settings.accel = AccelChoice::bvh;
  return settings;
}

/// Makes the first launch of the given name and all later launches fail.
class FailingLaunches {
 public:
  FailingLaunches(Session& session, std::string_view first) : session_(session) {
    on_launch(session, [this, first](const LaunchEvent& event) {
      if (event.kind == LaunchEvent::Kind::ends || (failures_ == 0 && event.name != first)) return;
      throw Error(ErrorCode::device, "failure " + std::to_string(++failures_));
    });
  }
  ~FailingLaunches() { on_launch(session_, {}); }
  FailingLaunches(const FailingLaunches&) = delete;
  FailingLaunches& operator=(const FailingLaunches&) = delete;

  int failures() const { return failures_; }

 private:
  Session& session_;
  int failures_ = 0;
};

/// Message of the error that `action` throws; empty without one.
template <typename F>
std::string error_of(const F& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

TEST(SessionErrors, UndoesFramesCompletelyAndThrowsTheFirstError) {
  RenderSettings settings = small_settings();
  settings.denoise = DenoiseChoice::svgf;
  Session session(find_builtin_scene("cornell")->build(), settings);
  for (int i = 0; i < 3; ++i) session.render_frame();
  const Image before = session.image();
  CameraPose moved = session.camera();
  moved.to_world[3] += 0.1f * moved.to_world[0];
  session.set_camera(moved);
  {
    const FailingLaunches failing(session, "svgf-present");
    const std::stop_source stop;
    EXPECT_EQ(error_of([&] { session.render_frame(stop.get_token()); }), "failure 1");
    EXPECT_GT(failing.failures(), 1) << "restoring the buffers fails, too";
  }
  EXPECT_EQ(session.image().pixels, before.pixels) << "of the last complete frame";
  EXPECT_EQ(session.frames_since_change(), 0u);
  EXPECT_TRUE(session.render_frame());
  EXPECT_EQ(session.frames_since_change(), 1u);
}

/// A launch fails after an edit has changed part of the scene.
void expect_new_histories(const std::function<void(Session&)>& change, const char* launch) {
  SCOPED_TRACE(launch);
  Session session(testing::figure(), small_settings());
  for (int i = 0; i < 3; ++i) session.render_frame();
  {
    const FailingLaunches failing(session, launch);
    EXPECT_EQ(error_of([&] { change(session); }), "failure 1");
  }
  EXPECT_EQ(session.frames_since_change(), 0u);
  change(session);
  session.render_frame();
  Session fresh(testing::figure(), small_settings());
  change(fresh);
  fresh.restart(small_settings().seed);
  fresh.render_frame();
  session.restart(small_settings().seed);
  session.render_frame();
  EXPECT_EQ(session.image().pixels, fresh.image().pixels);
}

TEST(SessionErrors, HistoriesEndWhereTheSceneChangedInPart) {
  expect_new_histories([](Session& session) { session.set_time(0.3f); }, "deformation");
}

TEST(SessionErrors, FailedChangesOfSettingsCanBeRepeated) {
  const RenderSettings settings = small_settings();
  RenderSettings resized = settings;
  resized.width += 5;
  Session session(find_builtin_scene("cornell")->build(), settings);
  session.render_frame();
  {
    const FailingLaunches failing(session, "scene");
    EXPECT_EQ(error_of([&] { session.set_settings(resized); }), "failure 1");
  }
  EXPECT_EQ(render_settings(session).width, settings.width);
  EXPECT_TRUE(session.render_frame());
  EXPECT_EQ(session.image().width, settings.width);
  EXPECT_TRUE(session.set_settings(resized));
  session.restart(resized.seed);
  session.render_frame();
  Session fresh(find_builtin_scene("cornell")->build(), resized);
  fresh.render_frame();
  EXPECT_EQ(session.image().width, resized.width);
  EXPECT_EQ(session.image().pixels, fresh.image().pixels);
}

TEST(SessionErrors, FramesAfterAFailedChangeShowTheWholeScene) {
  Scene scene = testing::figure();
  testing::add_light_node(scene, {.name = "bulb"}, Vec3(0, 3, 3), Vec3(0));
  PunctualLight bright;
  bright.intensity = Rgb(5);
  Session whole(scene, small_settings());
  whole.set_light(0, bright);
  whole.render_frame();
  testing::FailingMemory memory;
  Session session = make_session(scene, small_settings(), memory);
  memory.fail_after(0, std::numeric_limits<int>::max());
  EXPECT_THROW(session.set_light(0, bright), std::bad_alloc);
  EXPECT_TRUE(compiled_scene(session).is_stale());
  EXPECT_THROW(session.render_frame(), std::bad_alloc) << "of an empty scene";
  memory.recover();
  EXPECT_TRUE(session.render_frame());
  EXPECT_EQ(session.image().pixels, whole.image().pixels);
}

TEST(SessionErrors, LightCachesIncludeSamplesOnceIfTheThreadsChange) {
  Scene scene = testing::figure();
  for (const float x : {-2.0f, 0.5f, 1.5f}) testing::add_light_node(scene, {.name = "bulb"}, Vec3(x, 2, 2), Vec3(0));
  RenderSettings settings = small_settings();
  settings.lights = LightSelectionChoice::vlc;
  RenderSettings other = settings;
  other.threads = 1;
  const auto image_after_failure = [&](bool changes_threads) {
    Session session(scene, settings);
    for (int i = 0; i < 3; ++i) session.render_frame();
    {
      const FailingLaunches failing(session, "vlc.populate");
      EXPECT_EQ(error_of([&] { session.render_frame(); }), "failure 1");
    }
    if (changes_threads) {
      EXPECT_TRUE(session.set_settings(other));
    }
    for (int i = 0; i < 3; ++i) session.render_frame();
    return session.image().pixels;
  };
  EXPECT_EQ(image_after_failure(true), image_after_failure(false));
}

TEST(SessionErrors, HistoriesContinueAfterRejectedChanges) {
  Session session(find_builtin_scene("cornell")->build(), small_settings());
  session.render_frame();
  Environment invalid;
  invalid.rotation_rad = kInfinity;
  EXPECT_NE(error_of([&] { session.set_environment(invalid); }), "");
  EXPECT_EQ(session.frames_since_change(), 1u);
}

}  // namespace
}  // namespace relume
