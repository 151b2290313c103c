#include "support/glossy_floor.h"

#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "files/atomic_file.h"
#include "files/testing/temp_folder.h"
#include "relume/scene_io.h"
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

double squared_distance(const Rgb& a, const Rgb& b) { return static_cast<double>(length_squared(a - b)) / 3; }

}  // namespace

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

RenderSettings floor_settings() {
  RenderSettings s = small_settings(kWidth, kHeight);
  s.path.max_bounces = 4;
  return s;
}

std::vector<FloorTruth> floor_truths(const Scene& scene) {
  constexpr int kSamples = 64;
  std::vector<FloorTruth> list;
  RenderSettings s = floor_settings();
  s.seed = 1001;
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
    FloorTruth truth{halves[0], {}};
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

double floor_error(const Scene& scene, const std::vector<FloorTruth>& truths, RenderSettings settings) {
  double sum = 0;
  double pixels = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    settings.seed = seed;
    Session session(scene, settings);
    size_t compared = 0;
    for (int frame = 0; frame < kFrames; ++frame) {
      session.set_time(static_cast<float>(frame) / kFps);
      session.render_frame();
      if (compared == std::size(kCompared) || kCompared[compared] != frame) continue;
      const FloorTruth& t = truths[compared++];
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

}  // namespace relume::support
