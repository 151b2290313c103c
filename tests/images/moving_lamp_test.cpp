// Tests a lamp that moves after a rest, with reprojection and adaptive sampling: pixels follow it although their
// probability was settled.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "files/atomic_file.h"
#include "files/testing/temp_folder.h"
#include "relume/scene_io.h"
#include "render/session.h"
#include "support/measure.h"

namespace relume::support {
namespace {

constexpr int kSeeds = 3;
constexpr float kFps = 24;

/// Only the lamp moves, for one second.
constexpr const char* kLamp = R"({
  "scene": "builtin:cornell-closed",
  "camera": {"fov_y_deg": 60, "eye": [1.9, 2.9, 2.2], "target": [1.28, 2.68, 1.44]},
  "nodes": {"lamp": {"keys": [{"time": 0, "translation": [0, 0, 0]}, {"time": 1, "translation": [-0.9, -0.2, -0.6]}]}}
})";

double mean_luminance(const Image& image) {
  double sum = 0;
  for (const Rgb& pixel : image.pixels) sum += static_cast<double>(luminance(pixel));
  return sum / static_cast<double>(image.pixels.size());
}

/// Relative error of the last frame's mean against `truth`, after frames at rest, which settle probabilities, and
/// `frames` with a moving lamp.
double lag_behind_the_lamp(const Scene& scene, RenderSettings settings, int frames, const Image& truth) {
  constexpr int kRest = 40;
  double sum = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    settings.seed = seed;
    Session session(scene, settings);
    for (int i = 0; i < kRest; ++i) session.render_frame();
    for (int i = 1; i <= frames; ++i) {
      session.set_time(static_cast<float>(i) / kFps);
      session.render_frame();
    }
    sum += mean_luminance(session.image()) / mean_luminance(truth) - 1;
  }
  return sum / kSeeds;
}

// Regression test: pixels with their own probability were 9 % too bright, since they were not sampled while the lamp
// moved.
TEST(MovingLamp, AdaptivePixelsFollow) {
  constexpr int kMoving = 22;
  const TempFolder folder;
  write_file(folder / "scene.json", kLamp);
  const Scene scene = load_scene(folder / "scene.json");
  RenderSettings s = small_settings(64, 36);
  s.path.max_bounces = 4;
  s.time_s = static_cast<float>(kMoving) / kFps;
  s.seed = 1001;
  const Image truth = render(scene, s, 256);
  s.time_s = 0;
  s.history = HistoryChoice::reproject;
  const double alone = lag_behind_the_lamp(scene, s, kMoving, truth);
  s.allocation = AllocationChoice::adaptive;
  const double adaptive = lag_behind_the_lamp(scene, s, kMoving, truth);
  std::cerr << "behind the lamp: " << alone << " by reprojection, " << adaptive << " with adaptive allocation\n";
  EXPECT_LT(std::fabs(alone), 0.04);
  EXPECT_LT(std::fabs(adaptive), 0.04);  // indirect light lags, as in Motion.ObjectsLeaveNoTrails
}

}  // namespace
}  // namespace relume::support
