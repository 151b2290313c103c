// Bounds the share of threads that wait for others, on more threads than a test may use. No time is measured: the tiles
// of each launch are recorded, and a model schedules them onto the threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "determinism/task_model.h"
#include "frame/primitives/fill.h"
#include "render/session.h"
#include "render/settings.h"

namespace relume::support {
namespace {

constexpr int kFirstFrames = 3;  // the octree grows by a level in each
constexpr int kFrames = 2;
constexpr int kWidth = 640;
constexpr int kHeight = 360;
constexpr double kMostIdle = 0.05;

/// The tiles of a launch as tasks. A tile costs as much as it has elements, whatever the kernel computes for one.
/// Passes over all pixels thus have equal cost, and launches over the few nodes and regions of learned structures count
/// more than in time. Sets and copies of arrays only wait for memory: a tile of these counts as one of pixels.
TaskStep tasks_of(const LaunchTiles& grid) {
  const bool moves_memory = grid.tile_size == kFillTile;
  const double per_element = moves_memory ? static_cast<double>(kTileSize * kTileSize) / kFillTile : 1.0;
  TaskStep tasks;
  for (uint32_t i = 0; i < grid.tiles(); ++i) {
    const Tile tile = grid.tile(i);
    tasks.push_back(per_element * tile.width() * tile.height());
  }
  return tasks;
}

/// Names of the host code of a frame that is not a launch: changes of the camera, and clears of buffers in loops with a
/// task for each. It works on no pixels otherwise (`TimedHostCodeAccessesNoPixels`), so it counts as one tile.
constexpr std::string_view kHostCode[] = {"scene", "session"};

/// The outermost launches of a session or a backend, as steps of the model.
struct Launches {
  std::vector<TaskStep> steps;

  void add(const LaunchEvent& event) {
    if (event.kind != LaunchEvent::Kind::begins) return;
    if (event.grid.tile_size > 0) {
      steps.push_back(tasks_of(event.grid));
    } else {
      EXPECT_EQ(std::count(std::begin(kHostCode), std::end(kHostCode), event.name), 1)
          << event.name << " is host code of unknown cost; launch a kernel, or add the name and its cost";
      steps.push_back({kTileSize * kTileSize});
    }
  }
};

/// Frames of `interactive` at one sample per pixel, while the camera moves.
Launches frames_of_interactive() {
  RenderSettings settings = resolve({.preset = "interactive"}).render;
  settings.width = kWidth;
  settings.height = kHeight;
  settings.threads = 1;
  settings.path.max_bounces = 2;  // for the time of the test: tiles do not depend on it
  Session session(find_builtin_scene("cornell")->build(), settings);
  Launches launches;
  for (int frame = 0; frame < kFirstFrames + kFrames; ++frame) {
    if (frame == kFirstFrames) on_launch(session, [&](const LaunchEvent& event) { launches.add(event); });
    CameraPose camera = session.camera();
    camera.to_world[3].x += 0.01f;
    session.set_camera(camera);
    session.render_frame();
  }
  on_launch(session, {});
  return launches;
}

/// A launch over as many elements as the image has pixels, in tiles of `tile_size`.
TaskStep launch_over_pixels(uint32_t tile_size) {
  Backend backend(1);
  Array<uint32_t> values(backend.memory());
  values.reset(size_t{kWidth} * kHeight);
  Launches launches;
  backend.on_launch([&](const LaunchEvent& event) { launches.add(event); });
  launch(backend, "pass", FillElementsKernel<uint32_t>{values.mutable_view(), 1}, kWidth * kHeight, 1, {}, tile_size);
  return launches.steps.at(0);
}

TEST(TaskModel, ThreadsTakeTasksInOrder) {
  EXPECT_DOUBLE_EQ(schedule({}, 2), 0);
  EXPECT_DOUBLE_EQ(schedule({1, 2, 3}, 1), 6);
  EXPECT_DOUBLE_EQ(schedule({1, 1, 1, 1}, 2), 2);
  EXPECT_DOUBLE_EQ(schedule({3, 1, 1, 1}, 2), 3);
  EXPECT_DOUBLE_EQ(schedule({1, 1, 1, 3}, 2), 4) << "a long task at the end keeps one thread waiting";
  EXPECT_DOUBLE_EQ(schedule({1, 2}, 16), 2);
}

TEST(TaskModel, ThreadsWaitAtBarriers) {
  EXPECT_DOUBLE_EQ(idle_share({}, 2), 0);
  EXPECT_DOUBLE_EQ(idle_share({{1, 2}, {3}}, 1), 0);
  EXPECT_DOUBLE_EQ(idle_share({{1}, {1, 1}}, 2), 0.25);
  EXPECT_DOUBLE_EQ(idle_share({{1}, {1}}, 2), 0.5) << "these two tasks never run at once";
  EXPECT_NEAR(idle_share({TaskStep(1000, 1.0)}, 16), 1 - 1000.0 / (16 * 63), 1e-12);
}

TEST(IdleThreads, AreFewInFramesOfInteractive) {
  if (is_host_replaced()) GTEST_SKIP() << "launches on the host";
  const Launches frames = frames_of_interactive();
  size_t over_pixels = 0;
  for (const TaskStep& step : frames.steps) over_pixels += step.size() >= tasks_of({kWidth, kHeight, kTileSize}).size();
  EXPECT_GE(over_pixels, size_t{10} * kFrames) << "camera rays, paths, accumulation, features and steps of SVGF";
  for (const int threads : {2, 16}) {
    const double share = idle_share(frames.steps, threads);
    RecordProperty("idle_share_" + std::to_string(threads) + "_threads", std::to_string(share));
    EXPECT_LE(share, kMostIdle) << threads << " threads";
  }
}

/// The bound detects a single pass over the pixels that one thread executes, and one with a tile for every 100 rows.
TEST(IdleThreads, AreManyIfOnePassHasFewTiles) {
  if (is_host_replaced()) GTEST_SKIP() << "launches on the host";
  const Launches frames = frames_of_interactive();
  for (const uint32_t rows : {static_cast<uint32_t>(kHeight), 100u}) {
    std::vector<TaskStep> steps = frames.steps;
    for (int frame = 0; frame < kFrames; ++frame) steps.push_back(launch_over_pixels(rows * kWidth));
    EXPECT_GT(idle_share(steps, 16), kMostIdle) << rows << " rows per tile";
  }
  std::vector<TaskStep> steps = frames.steps;
  for (int frame = 0; frame < kFrames; ++frame) steps.push_back(launch_over_pixels(kTileSize * kTileSize));
  EXPECT_LE(idle_share(steps, 16), kMostIdle) << "with tiles as small as those of other passes";
}

}  // namespace
}  // namespace relume::support
