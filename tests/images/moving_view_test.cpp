// Tests forward reprojection with a walking and turning camera: filling pixels without a history removes most of their
// noise.
#include <gtest/gtest.h>

#include <iostream>
#include <string>
#include <vector>

#include "files/atomic_file.h"
#include "files/testing/temp_folder.h"
#include "relume/scene_io.h"
#include "render/session.h"
#include "support/measure.h"

namespace relume::support {
namespace {

constexpr int kFrames = 8;
constexpr int kSeeds = 3;

Scene box_seen_by(const std::string& camera_keys) {
  const TempFolder folder;
  write_file(folder / "scene.json",
             R"({"scene": "builtin:cornell", "camera": {"fov_y_deg": 50}, "camera_keys": )" + camera_keys + "}");
  return load_scene(folder / "scene.json");
}

RenderSettings settings_of(bool fill, int seed) {
  RenderSettings s = small_settings(96, 54);
  s.path.max_bounces = 4;
  s.history = HistoryChoice::reproject;
  s.reproject.fill = fill;
  s.seed = seed;
  return s;
}

/// MSE of the last of kFrames frames, `step` seconds apart: mean over the seeds.
double last_error(const Scene& scene, float step, bool fill, const Image& truth) {
  double sum = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    Session session(scene, settings_of(fill, seed));
    for (int frame = 0; frame < kFrames; ++frame) {
      session.set_time(static_cast<float>(frame) * step);
      session.render_frame();
    }
    sum += mse(session.image(), truth) / kSeeds;
  }
  return sum;
}

void expect_less_error(const Scene& scene, float step) {
  RenderSettings still = settings_of(true, 1001);
  still.time_s = (kFrames - 1) * step;
  const Image truth = render(scene, still, 256);
  const double holes = last_error(scene, step, false, truth);
  const double filled = last_error(scene, step, true, truth);
  std::cerr << "MSE with holes " << holes << ", filled " << filled << "\n";
  EXPECT_LT(filled, 0.75 * holes);
}

TEST(MovingView, ForwardReprojectionLeavesNoHolesInAWalk) {
  expect_less_error(box_seen_by(R"([{"time": 0, "eye": [1.6, 3.2, 5.0], "target": [0.3, 2.4, 0]},
                                    {"time": 1, "eye": [-0.3, 2.9, 4.0], "target": [0, 2.3, 0]}])"),
                    1.0f / 24);
}

TEST(MovingView, ForwardReprojectionLeavesNoHolesInATurn) {
  expect_less_error(box_seen_by(R"([{"time": 0, "eye": [0.6, 2.8, 4.2], "target": [0.1, 2.6, 0]},
                                    {"time": 1, "eye": [0.6, 2.8, 4.2], "target": [2.6, 2.6, 0.4]}])"),
                    1.0f / 24);
}

}  // namespace
}  // namespace relume::support
