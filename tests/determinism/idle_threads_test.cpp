// Bounds the time in which threads wait for others, on more threads than a test may use: the tiles of frames are timed
// on one thread, and a model schedules them onto more.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "builtin_scenes/builtin.h"
#include "determinism/task_model.h"
#include "render/session.h"
#include "render/settings.h"
#include "support/thread_clock.h"

namespace relume::support {
namespace {

constexpr int kFirstFrames = 3;  // these allocate
constexpr int kFrames = 4;
constexpr int kTries = 3;  // interrupts lengthen single tiles
constexpr double kMostIdleOfTwo = 0.05;
constexpr double kMostIdleOfSixteen = 0.25;

/// Records the steps of a session on one thread. Host code within launches counts as serial, as do its parallel loops.
class Recorder {
 public:
  explicit Recorder(Session& session) : session_(session) {
    on_launch(session_, [this](const LaunchEvent&) { begin_step(); });
    on_tile(session_, [this] { begin(true); });
  }
  ~Recorder() {
    on_launch(session_, {});
    on_tile(session_, {});
  }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  void render_frame() {
    is_task_ = false;
    last_s_ = thread_s();
    steps_.emplace_back();
    session_.render_frame();
    begin_step();
  }
  /// Steps of all frames so far.
  const std::vector<TaskStep>& steps() const { return steps_; }

 private:
  /// Adds the time since the last call to the step, as a task or as serial work, whichever had begun.
  void begin(bool is_task) {
    const double now_s = thread_s();
    TaskStep& step = steps_.back();
    if (is_task_) {
      step.tasks_s.push_back(now_s - last_s_);
    } else {
      step.serial_s += now_s - last_s_;
    }
    is_task_ = is_task;
    last_s_ = thread_s();  // without the time of this function
  }
  void begin_step() {
    begin(false);
    steps_.emplace_back();
  }

  Session& session_;
  std::vector<TaskStep> steps_ = std::vector<TaskStep>(1);
  double last_s_ = 0;
  bool is_task_ = false;
};

/// Frames of `interactive` at one sample per pixel, while the camera moves.
class Interactive {
 public:
  Interactive() : session_(find_builtin_scene("cornell")->build(), settings()) {
    for (int frame = 0; frame < kFirstFrames; ++frame) {
      move();
      session_.render_frame();
    }
  }

  Session& session() { return session_; }
  std::vector<TaskStep> steps() {
    Recorder recorder(session_);
    for (int frame = 0; frame < kFrames; ++frame) {
      move();
      recorder.render_frame();
    }
    return recorder.steps();
  }

 private:
  static RenderSettings settings() {
    RenderSettings s = resolve({.preset = "interactive"}).render;
    s.width = 640;
    s.height = 360;
    s.threads = 1;
    return s;
  }
  void move() {
    CameraPose camera = session_.camera();
    camera.to_world[3].x += 0.01f;
    session_.set_camera(camera);
  }

  Session session_;
};

TEST(TaskModel, ThreadsTakeTasksInOrder) {
  EXPECT_DOUBLE_EQ(schedule_s({}, 2), 0);
  EXPECT_DOUBLE_EQ(schedule_s({1, 2, 3}, 1), 6);
  EXPECT_DOUBLE_EQ(schedule_s({1, 1, 1, 1}, 2), 2);
  EXPECT_DOUBLE_EQ(schedule_s({3, 1, 1, 1}, 2), 3);
  EXPECT_DOUBLE_EQ(schedule_s({1, 1, 1, 3}, 2), 4) << "a long task at the end keeps one thread waiting";
  EXPECT_DOUBLE_EQ(schedule_s({1, 2}, 16), 2);
}

TEST(TaskModel, ThreadsWaitForSerialWorkAndAtBarriers) {
  EXPECT_DOUBLE_EQ(idle_share({}, 2), 0);
  EXPECT_DOUBLE_EQ(idle_share({{1, {1, 2}}, {2, {3}}}, 1), 0);
  EXPECT_DOUBLE_EQ(idle_share({{1}, {0, {1, 1}}}, 2), 0.25);
  EXPECT_DOUBLE_EQ(idle_share({{0, {1}}, {0, {1}}}, 2), 0.5) << "these two tasks never run at once";
  EXPECT_NEAR(idle_share({{0, std::vector<double>(1000, 1.0)}}, 16), 1 - 1000.0 / (16 * 63), 1e-12);
}

TEST(IdleThreads, AreFewInFramesOfInteractive) {
  if (is_host_replaced()) GTEST_SKIP() << "times of the host";
  Interactive interactive;
  double of_two = 1;
  double of_sixteen = 1;
  for (int i = 0; i < kTries && (of_two > kMostIdleOfTwo || of_sixteen > kMostIdleOfSixteen); ++i) {
    const std::vector<TaskStep> steps = interactive.steps();
    of_two = std::min(of_two, idle_share(steps, 2));
    of_sixteen = std::min(of_sixteen, idle_share(steps, 16));
  }
  RecordProperty("idle_share_2_threads", std::to_string(of_two));
  RecordProperty("idle_share_16_threads", std::to_string(of_sixteen));
  EXPECT_LE(of_two, kMostIdleOfTwo);
  EXPECT_LE(of_sixteen, kMostIdleOfSixteen);
}

TEST(IdleThreads, AreManyIfAPassWorksAlone) {
  if (is_host_replaced()) GTEST_SKIP() << "times of the host";
  Interactive interactive;
  double frames_s = 0;
  for (const TaskStep& step : interactive.steps()) {
    frames_s += step.serial_s;
    for (const double task_s : step.tasks_s) frames_s += task_s;
  }
  const double alone_s = 0.2 * frames_s / kFrames;
  const std::string last = interactive.session().passes().back().name;
  interactive.session().on_pass([&](const std::string& pass) {
    const double start_s = thread_s();
    while (pass == last && thread_s() - start_s < alone_s) continue;
  });
  const std::vector<TaskStep> steps = interactive.steps();
  EXPECT_GT(idle_share(steps, 2), kMostIdleOfTwo);
  EXPECT_GT(idle_share(steps, 16), kMostIdleOfSixteen);
}

}  // namespace
}  // namespace relume::support
