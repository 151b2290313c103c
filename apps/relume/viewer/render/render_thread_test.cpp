#include "viewer/render/render_thread.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <ctime>
#include <future>
#include <thread>

#include "relume/error.h"
#include "scene/scene_hash.h"
#include "viewer/model/setting_rules.h"
#include "viewer/testing/render_stage.h"

namespace relume::viewer {
namespace {

using testing::kPatience_ms;
using testing::Stage;

double mean_luminance(const ViewerFrame& frame) {
  double sum = 0;
  for (const Rgb& c : frame.radiance) sum += static_cast<double>(luminance(c));
  return sum / static_cast<double>(frame.radiance.size());
}

TEST(RenderThread, RendersAndRefines) {
  Stage stage;
  stage.post();
  auto frame = stage.next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->width, 32);
  EXPECT_GT(mean_luminance(*frame), 0);
  const double samples = frame->samples;
  for (int i = 0; i < kPatience_ms && stage.thread.frame(0)->samples <= samples; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_GT(stage.thread.frame(0)->samples, samples);
  EXPECT_FALSE(frame->passes.empty());
}

TEST(RenderThread, EveryStreamOfCameraChangesIsFollowedByImages) {
  Stage stage;
  stage.post();
  ASSERT_TRUE(stage.next());
  CameraPose camera = stage.next()->camera;
  const uint64_t enough = stage.thread.frame(0)->serial + 5;
  for (int i = 0; i < kPatience_ms && stage.thread.frame(0)->serial <= enough; ++i) {  // faster than frames
    camera.to_world[3].x += 0.001f;
    stage.document.set_camera(camera);
    stage.post();
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  EXPECT_GT(stage.thread.frame(0)->serial, enough) << "no frames came while the camera moved";
  const auto frame = stage.next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->camera.to_world, camera.to_world);
}

TEST(RenderThread, SlowChangesAreNotRest) {
  // Every edit takes longer than the time until rest, and longer than the interval between edits. Frames must follow
  // nevertheless.
  Stage stage("cornell-water");  // many triangles, which all become lamps
  stage.resolution_policy = {.hold_rate = true, .target_hz = 1000, .full_at_rest = true, .rest_after_s = 0.005f};
  std::vector<Material> materials = stage.document.outline().materials;
  stage.post();
  ASSERT_TRUE(stage.next());
  const uint64_t enough = stage.thread.frame(0)->serial + 3;
  for (int i = 0; i < kPatience_ms / 3 && stage.thread.frame(0)->serial <= enough; ++i) {
    for (size_t k = 0; k < materials.size(); ++k) {
      materials[k].emission = Rgb(1.0f + static_cast<float>(i));
      stage.document.set_material(static_cast<Index>(k), materials[k]);
    }
    stage.post();
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  EXPECT_GT(stage.thread.frame(0)->serial, enough) << "no frames came during slow edits";
}

TEST(RenderThread, AGoalThatIsMetAtASmallSizeDoesNotKeepTheImageSmall) {
  Stage stage;
  stage.settings[0].render.width = 1000;
  stage.settings[0].render.height = 600;
  stage.settings[0].stop.spp = 1;
  stage.resolution_policy = {.hold_rate = true, .target_hz = 1000, .full_at_rest = true, .rest_after_s = 0.3f};
  stage.post();
  const auto first = stage.next();
  ASSERT_TRUE(first);
  EXPECT_LT(first->width, 1000);
  EXPECT_FALSE(first->reached_goal);
  for (int i = 0; i < kPatience_ms && !stage.thread.frame(0)->reached_goal; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_TRUE(stage.thread.frame(0)->reached_goal);
  EXPECT_EQ(stage.thread.frame(0)->width, 1000);
}

TEST(RenderThread, UpscalesInMotionAndTracesEveryPixelAtRest) {
  Stage stage;
  stage.settings[0].render.width = 400;
  stage.settings[0].render.height = 240;
  stage.settings[0].render.denoise = DenoiseChoice::svgf;
  stage.resolution_policy = {
      .hold_rate = true, .upscale = true, .target_hz = 1000, .full_at_rest = true, .rest_after_s = 0.3f};
  stage.post();
  const auto moving = stage.next();
  ASSERT_TRUE(moving);
  EXPECT_EQ(moving->upscale, 2);
  for (int i = 0; i < kPatience_ms && stage.thread.frame(0)->width < 400; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_EQ(stage.thread.frame(0)->width, 400);
  EXPECT_EQ(stage.thread.frame(0)->upscale, 1);
}

TEST(RenderThread, UpscalesOnlyIfADenoiserFillsThePixels) {
  Stage stage;
  stage.resolution_policy = {.hold_rate = true, .upscale = true, .target_hz = 1000};
  stage.post();
  const auto frame = stage.next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->upscale, 1);
}

TEST(RenderThread, StopsAtTheWantedSamplesAndStartsAgain) {
  Stage stage;
  stage.settings[0].stop.spp = 3;
  stage.post();
  ASSERT_TRUE(stage.next());
  for (int i = 0; i < kPatience_ms && !stage.thread.frame(0)->reached_goal; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(stage.thread.frame(0)->samples, 3) << "allocation is uniform";
  stage.settings[0].render.seed = 1;
  stage.post();
  EXPECT_TRUE(stage.next());
}

TEST(RenderThread, BothSidesStopAtTheWantedErrorThoughOneIsAFrameAhead) {
  Stage stage;
  stage.paused = true;  // one frame per request
  stage.post();
  ASSERT_TRUE(stage.next());
  stage.split = true;
  stage.post();
  ASSERT_TRUE(stage.next(0) && stage.next(1));
  stage.paused = false;
  stage.post();
  // From 64 frames on the error is checked in every fourth, which never coincides on both sides.
  for (int i = 0; i < kPatience_ms && stage.thread.frame(1)->samples < 70; ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  for (AllSettings& s : stage.settings) s.stop.error = 1000;
  stage.post();
  const auto both_stopped = [&] { return stage.thread.frame(0)->reached_goal && stage.thread.frame(1)->reached_goal; };
  for (int i = 0; i < kPatience_ms && !both_stopped(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  const uint64_t serial = stage.thread.frame(0)->serial;
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  EXPECT_EQ(stage.thread.frame(0)->serial, serial);
  EXPECT_TRUE(both_stopped());
}

TEST(RenderThread, AppliesEverySlotAndSettingWithoutARestart) {
  Stage stage;
  stage.settings[0].render.static_lists.rays = 64;  // short preparation, even on a busy machine
  stage.post();
  ASSERT_TRUE(stage.next());
  RenderSettings defaults = stage.settings[0].render;
  const SettingList slots = describe_slots(defaults);
  for (const Setting& slot : slots) {
    for (const std::string_view name : std::get<ChoiceRef>(slot.value).names) {
      if (!refusal(stage.settings[0], slot.name, name).empty()) continue;
      AllSettings wanted = stage.settings[0];
      store(require_setting(describe(wanted), slot.name, ""), std::string(name));
      std::swap(stage.settings[0], wanted);
      stage.post();
      const auto frame = stage.next();
      ASSERT_TRUE(frame) << slot.name << " " << name;
      EXPECT_GT(mean_luminance(*frame), 0) << slot.name << " " << name;
      std::swap(stage.settings[0], wanted);
    }
  }
  stage.settings[0].render.texture_filter = TextureFilter::encoded;  // recompiles the scene
  stage.post();
  EXPECT_TRUE(stage.next());
}

TEST(RenderThread, ShowsBothSidesAndTheSameEditsOnEach) {
  Stage stage;
  stage.split = true;
  stage.settings[1].render.path.max_bounces = 0;
  stage.post();
  auto a = stage.next(0);
  auto b = stage.next(1);
  ASSERT_TRUE(a && b);
  EXPECT_GT(mean_luminance(*a), 1.1 * mean_luminance(*b)) << "B has no indirect light, nor any but emission";
  CameraPose camera = a->camera;
  camera.to_world[3].z += 0.1f;
  stage.document.set_camera(camera);
  stage.post();
  a = stage.next(0);
  b = stage.next(1);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->camera.to_world, b->camera.to_world);
}

TEST(RenderThread, LightsMaterialsAndObjectsChangeWhileItRenders) {
  Stage stage;
  stage.post();
  ASSERT_TRUE(stage.next());
  const double before = mean_luminance(*stage.next());
  const Scene& scene = stage.document.outline();
  for (size_t i = 0; i < scene.materials.size(); ++i) {
    if (is_black(scene.materials[i].emission)) continue;
    Material brighter = scene.materials[i];
    brighter.emission *= 4.0f;
    stage.document.set_material(static_cast<Index>(i), brighter);
  }
  stage.post();
  const auto bright = stage.next();
  ASSERT_TRUE(bright);
  EXPECT_GT(mean_luminance(*bright), 2 * before);

  const auto lamp =
      std::find_if(scene.nodes.begin(), scene.nodes.end(), [](const Node& n) { return n.name == "lamp"; });
  const auto node = static_cast<Index>(lamp - scene.nodes.begin());
  ASSERT_TRUE(stage.document.make_movable(node));
  stage.post();
  ASSERT_TRUE(stage.next());
  stage.document.move(node, {0, 100, 0});
  stage.post();
  const auto moved = stage.next();
  ASSERT_TRUE(moved);
  EXPECT_LT(mean_luminance(*moved), 0.1 * before) << "the ceiling hides the lamp";
}

TEST(RenderThread, UnrenderableSettingsKeepTheScene) {
  Stage stage;
  stage.post();
  ASSERT_TRUE(stage.next());
  const auto before = stage.thread.frame(0);
  stage.settings[0].render.camera = "no such camera";
  stage.post();
  EXPECT_NE(stage.problem().find("no such camera"), std::string::npos);
  EXPECT_EQ(stage.thread.frame(0)->scene, before->scene);
  stage.settings[0].render.camera.clear();
  stage.post();
  EXPECT_TRUE(stage.next());
}

TEST(RenderThread, BuffersAreRead) {
  Stage stage;
  stage.buffer = "normal";
  stage.post();
  const auto frame = stage.next();
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->channels, "XYZ");
  ASSERT_EQ(frame->values.size(), frame->radiance.size());
  EXPECT_NEAR(glm::length(frame->values[12 * 32 + 16]), 1, 0.2f) << "the back wall, and an edge perhaps";
  stage.buffer = "no such buffer";
  stage.post();
  const auto without = stage.next();
  ASSERT_TRUE(without);
  EXPECT_TRUE(without->values.empty());
}

TEST(RenderThread, PicksTheObjectUnderAPoint) {
  Stage stage;
  stage.post();
  ASSERT_TRUE(stage.next());
  std::promise<PickResult> promise;
  stage.thread.post_task([&](const Session& session, const LoadedScene&) {
    promise.set_value(pick(session, {0.5f, 0.5f}));
  });
  const PickResult result = promise.get_future().get();
  EXPECT_TRUE(result.hit);
  EXPECT_GE(result.node, 0);
  EXPECT_GT(length_squared(result.position), 0);
}

TEST(RenderThread, TasksGetTheSceneOfTheirSessionWhileAnotherIsAskedFor) {
  Stage stage;
  stage.post();
  ASSERT_TRUE(stage.next());
  stage.document =
      Document(std::make_shared<const LoadedScene>(LoadedScene{"furnace", find_builtin_scene("furnace")->build()}));
  stage.post();
  std::promise<bool> promise;
  stage.thread.post_task([&](const Session& session, const LoadedScene& scene) {
    promise.set_value(scene_hash(scene.scene) == session.scene_hash());
  });
  EXPECT_TRUE(promise.get_future().get());
}

TEST(RenderThread, TasksWaitForTheFirstSceneWithoutKeepingACoreBusy) {
  Stage stage;
  std::promise<bool> promise;
  stage.thread.post_task([&](const Session&, const LoadedScene&) { promise.set_value(true); });
  const std::clock_t before = std::clock();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_LT(std::clock() - before, CLOCKS_PER_SEC / 10) << "processor time, half of what a spinning thread takes";
  stage.post();
  EXPECT_TRUE(promise.get_future().get());
}

TEST(RenderThread, CompletesRequestsBeforeItEnds) {
  Stage stage;
  stage.post();
  ASSERT_TRUE(stage.next());
  int done = 0;
  for (int i = 0; i < 3; ++i) stage.thread.post_task([&](const Session&, const LoadedScene&) { ++done; });
  stage.thread.post_task([](const Session&, const LoadedScene&) { throw Error("no room"); });
  stage.thread.stop();
  EXPECT_EQ(done, 3);
  const std::vector<Notice> notices = stage.thread.take_notices();
  ASSERT_EQ(notices.size(), 1u);
  EXPECT_TRUE(notices[0].failed_task);
}

TEST(RenderThread, FinishesAFrameOfTheLastRequestBeforeItStops) {
  // Slow frames of a different size, so that the end comes before the first is complete.
  Stage stage;
  stage.post();
  ASSERT_TRUE(stage.next());
  stage.settings[0].render.width = 300;
  stage.settings[0].render.height = 200;
  stage.resolution_policy = {.hold_rate = true, .full_at_rest = true, .rest_after_s = 0};
  stage.post();
  std::atomic<int> width = 0;
  std::this_thread::sleep_for(std::chrono::milliseconds(3));
  stage.thread.post_task([&](const Session& session, const LoadedScene&) {
    EXPECT_GT(session.frames_since_change(), 0u);
    width = render_settings(session).width;
  });
  stage.thread.stop();
  EXPECT_GT(width, 0);
}

TEST(RenderThread, TasksSeeACompleteFrameWhileTheNextIsRequested) {
  Stage stage;
  stage.post();
  ASSERT_TRUE(stage.next());
  for (int i = 0; i < 20; ++i) {
    CameraPose camera = stage.thread.frame(0)->camera;
    camera.to_world[3].x += 0.01f;
    stage.document.set_camera(camera);
    stage.post();
    std::promise<uint32_t> frames;
    stage.thread.post_task(
        [&](const Session& session, const LoadedScene&) { frames.set_value(session.frames_since_change()); });
    EXPECT_GT(frames.get_future().get(), 0u);
  }
}

TEST(RenderThread, EndsAtAnyMoment) {
  for (int i = 0; i < 20; ++i) {
    Stage stage;
    stage.post();
    if (i % 2 == 1) {
      ASSERT_TRUE(stage.next());
    }
    stage.thread.post_task([](const Session&, const LoadedScene&) {});
    std::this_thread::sleep_for(std::chrono::microseconds(300 * i));
  }
}

}  // namespace
}  // namespace relume::viewer
