// Tests a reflective floor with a walking camera. Separate diffuse and specular histories reduce its error: reflections
// are reprojected by their own motion, not the floor's.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <iterator>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "files/atomic_file.h"
#include "files/testing/temp_folder.h"
#include "relume/scene_io.h"
#include "render/session.h"
#include "support/measure.h"

namespace relume::support {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 90;
constexpr int kFrames = 16;
constexpr int kCompared[] = {11, 15};
constexpr int kSeeds = 2;
constexpr float kFps = 24;

constexpr const char* kWalk = R"({
  "scene": "builtin:cornell",
  "camera": {"fov_y_deg": 50},
  "camera_keys": [{"time": 0, "eye": [1.6, 1.2, 5.0], "target": [0.3, 0.4, 0]},
                  {"time": 0.75, "eye": [0.2, 1.1, 4.2], "target": [0.0, 0.4, 0]}]
})";

/// The Cornell box with a dark, polished floor.
Scene polished_box(float roughness) {
  const TempFolder folder;
  write_file(folder / "scene.json", std::string(kWalk));
  Scene scene = load_scene(folder / "scene.json");
  Material polished;
  polished.name = "polished";
  polished.base_color = Rgb(0.1f);
  polished.metallic = 0;
  polished.roughness = roughness;
  scene.materials.push_back(polished);
  for (Mesh& mesh : scene.meshes) {
    if (mesh.name == "floor") mesh.material = static_cast<Index>(scene.materials.size()) - 1;
  }
  return scene;
}

RenderSettings settings_of(int seed) {
  RenderSettings s = small_settings(kWidth, kHeight);
  s.path.max_bounces = 4;
  s.seed = seed;
  return s;
}

struct Truth {
  Image image;
  std::vector<bool> floor;  ///< pixels that show the floor
  double noise = 0;         ///< MSE of the reference at the floor
};

double squared_distance(const Rgb& a, const Rgb& b) { return static_cast<double>(length_squared(a - b)) / 3; }

/// Means of two images of independent seeds, whose difference gives the noise of that mean.
std::vector<Truth> truths(const Scene& scene) {
  constexpr int kSamples = 64;
  std::vector<Truth> list;
  RenderSettings s = settings_of(1001);
  s.auxiliary = true;
  Session session(scene, s);
  for (const int frame : kCompared) {
    session.set_time(static_cast<float>(frame) / kFps);
    Image halves[2];
    for (int half = 0; half < 2; ++half) {
      session.restart(1001 + half);
      for (int i = 0; i < kSamples; ++i) session.render_frame();
      halves[half] = session.image();
    }
    Truth truth{halves[0], {}};
    const View<const Vec3> position = buffer_table(session).read(kSurface.position);
    const View<const Vec3> normal = buffer_table(session).read(kSurface.normal);
    for (uint32_t i = 0; i < position.size; ++i)
      truth.floor.push_back(normal[i].y > 0.9f && std::fabs(position[i].y) < 0.01f);
    double pixels = 0;
    for (size_t i = 0; i < truth.floor.size(); ++i) {
      truth.image.pixels[i] = 0.5f * (halves[0].pixels[i] + halves[1].pixels[i]);
      if (!truth.floor[i]) continue;
      truth.noise += 0.25 * squared_distance(halves[0].pixels[i], halves[1].pixels[i]);
      pixels += 1;
    }
    truth.noise /= pixels;
    list.push_back(std::move(truth));
  }
  return list;
}

/// MSE of the floor's pixels, minus the noise of the reference.
double floor_error(const Scene& scene, const std::vector<Truth>& truth, DenoiseChoice denoise, bool split) {
  double sum = 0;
  double pixels = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    RenderSettings s = settings_of(seed);
    s.denoise = denoise;
    s.features.split = split;
    Session session(scene, s);
    size_t compared = 0;
    for (int frame = 0; frame < kFrames; ++frame) {
      session.set_time(static_cast<float>(frame) / kFps);
      session.render_frame();
      if (compared == std::size(kCompared) || kCompared[compared] != frame) continue;
      const Truth& t = truth[compared++];
      const Image image = session.image();
      for (size_t i = 0; i < image.pixels.size(); ++i) {
        if (!t.floor[i]) continue;
        sum += squared_distance(image.pixels[i], t.image.pixels[i]) - t.noise;
        pixels += 1;
      }
    }
  }
  EXPECT_GT(pixels, kSeeds * 2 * kWidth * kHeight / 8);
  return sum / pixels;
}

void expect_less_error(float roughness, double svgf, double bmfr) {
  const Scene scene = polished_box(roughness);
  const std::vector<Truth> truth = truths(scene);
  for (const auto& [denoise, name, bound] :
       {std::tuple{DenoiseChoice::svgf, "svgf", svgf}, std::tuple{DenoiseChoice::bmfr, "bmfr", bmfr}}) {
    const double together = floor_error(scene, truth, denoise, false);
    const double apart = floor_error(scene, truth, denoise, true);
    std::cerr << name << ", roughness " << roughness << ": floor's MSE " << together << ", apart " << apart << ", "
              << apart / together << "\n";
    EXPECT_LT(apart, bound * together) << name;
  }
}

TEST(GlossyFloor, HasLessErrorIfPolished) { expect_less_error(0.1f, 0.6, 0.6); }
// Wide lobes blur reflections, so that the gain is lower.
TEST(SlowGlossyFloor, HasLessErrorIfSatin) { expect_less_error(0.25f, 0.7, 0.65); }

}  // namespace
}  // namespace relume::support
