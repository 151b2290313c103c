// Sessions with each acceleration structure: the same images, through animation, edits and checkpoints.
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "builtin_scenes/builtin.h"
#include "files/testing/temp_folder.h"
#include "render/session.h"
#include "render/session_state.h"
#include "scene/testing/figure.h"

namespace relume {
namespace {

RenderSettings settings_with(AccelChoice accel, int threads = 2) {
  RenderSettings settings;
  settings.width = 48;
  settings.height = 27;
  settings.threads = threads;
  settings.accel = accel;
  return settings;
}

Image rendered(Session& session, int frames) {
  for (int i = 0; i < frames; ++i) session.render_frame();
  return session.image();
}

size_t different_pixels(const Image& a, const Image& b) {
  size_t count = 0;
  for (size_t i = 0; i < a.pixels.size(); ++i) count += a.pixels[i] != b.pixels[i];
  return count;
}

/// Maximum number of pixels that may differ between the structures. They differ where a ray hits an edge.
constexpr size_t kFewPixels = 3;

TEST(AccelChoiceOfSession, GivesTheSameImages) {
  for (const char* name : {"cornell", "cornell-glass", "city"}) {
    const Scene scene = find_builtin_scene(name)->build();
    Session embree(scene, settings_with(AccelChoice::embree));
    Session bvh(scene, settings_with(AccelChoice::bvh));
    EXPECT_LE(different_pixels(rendered(embree, 2), rendered(bvh, 2)), kFewPixels) << name;
  }
}

TEST(AccelChoiceOfSession, GivesTheSameBitsWithAnyNumberOfThreads) {
  const Scene scene = find_builtin_scene("cornell-glass")->build();
  Session one(scene, settings_with(AccelChoice::bvh, 1));
  Session three(scene, settings_with(AccelChoice::bvh, 3));
  EXPECT_EQ(different_pixels(rendered(one, 3), rendered(three, 3)), 0u);
}

// Devices keep denormals; Embree is faster without.
TEST(AccelChoiceOfSession, DecidesWhetherKernelsKeepDenormals) {
  for (const bool scalar : {false, true}) {
    const auto square_of_1e_20 = [&](AccelChoice accel) {
      RenderSettings settings = settings_with(accel);
      settings.scalar_kernels = scalar;
      volatile float x = 1e-20f;
      float square = 1;
      make_backend(settings, host_memory(), nullptr)->execute([&] { square = x * x; });
      return square;
    };
    EXPECT_EQ(square_of_1e_20(AccelChoice::bvh), 0x116c2p-149f);
    EXPECT_EQ(square_of_1e_20(AccelChoice::embree), 0.0f);
  }
}

TEST(AccelChoiceOfSession, FollowsAnimation) {
  for (const Scene& scene : {testing::figure(), find_builtin_scene("turntable")->build()}) {
    Session embree(scene, settings_with(AccelChoice::embree));
    Session bvh(scene, settings_with(AccelChoice::bvh));
    for (const float time_s : {0.2f, 0.9f, 0.5f}) {
      embree.set_time(time_s);
      bvh.set_time(time_s);
      EXPECT_LE(different_pixels(rendered(embree, 1), rendered(bvh, 1)), kFewPixels) << time_s;
    }
  }
}

/// Mean luminances of images of a scene with different seeds. Pixels are clamped: otherwise, rare bright caustics would
/// hide errors. One session renders all: building the city takes longer than its frames.
std::vector<double> means(const Scene& scene, AccelChoice accel, int first_seed, int count) {
  constexpr double kBrightest = 2;
  std::vector<double> list;
  Session session(scene, settings_with(accel));
  for (int i = 0; i < count; ++i) {
    session.restart(first_seed + i);
    double sum = 0;
    for (const Rgb& pixel : rendered(session, 4).pixels) sum += std::min(double{luminance(pixel)}, kBrightest);
    list.push_back(sum / (48 * 27));
  }
  return list;
}

double mean_of(const std::vector<double>& list) { return std::accumulate(list.begin(), list.end(), 0.0) / list.size(); }

double variance_of_mean(const std::vector<double>& list) {
  const double mean = mean_of(list);
  double sum = 0;
  for (const double x : list) sum += (x - mean) * (x - mean);
  return sum / (list.size() * (list.size() - 1.0));
}

/// Standard deviations by which the difference of two means may exceed 0.
constexpr double kMostDeviations = 4;
/// Smallest error that the test detects, as a fraction of the mean: noise must not hide it. An error of this size fails
/// the test in half of all cases at least, one of one and a half times the size in 97 %.
constexpr double kDetectedError = 0.1;

TEST(AccelChoiceOfSession, KeepsTheMean) {
  for (const char* name : {"cornell", "cornell-glass", "city", "turntable"}) {
    const Scene scene = find_builtin_scene(name)->build();
    const std::vector<double> embree = means(scene, AccelChoice::embree, 1, 12);
    const std::vector<double> bvh = means(scene, AccelChoice::bvh, 101, 12);
    const double deviation = std::sqrt(variance_of_mean(bvh) + variance_of_mean(embree));
    const double most = kMostDeviations * deviation;
    EXPECT_LT(std::fabs(mean_of(bvh) - mean_of(embree)), most)
        << name << ": " << mean_of(embree) << " and " << mean_of(bvh);
    EXPECT_LT(most, kDetectedError * mean_of(embree)) << name << ": render more seeds";
  }
}

/// Adds two emissive, half-transparent triangles, moves them, changes their material twice, and removes one.
Image edited(AccelChoice accel) {
  Session session(find_builtin_scene("cornell")->build(), settings_with(accel));
  rendered(session, 1);
  Material material;
  material.emission = Rgb(1, 2, 3);
  material.alpha = 0.5f;
  material.alpha_mode = AlphaMode::blend;
  Mesh mesh;
  mesh.positions = {{-0.5f, -0.5f, 0}, {0.5f, -0.5f, 0}, {0, 0.5f, 0}};
  mesh.triangles = {{0, 1, 2}};
  mesh.material = session.add_material(material).index;
  Node place;
  place.meshes = {session.add_mesh(mesh).index};
  place.matrix = session.camera().to_world;
  (*place.matrix)[3] -= 2.0f * session.camera().to_world[2];
  const NodeHandle first = session.add_node(place);
  const NodeHandle second = session.add_node(place);
  rendered(session, 1);
  session.set_transform(first, {.translation = {0.2f, 0.8f, 0.1f}});
  session.set_transform(second, {.translation = {-0.4f, 1.8f, 0.3f}});
  rendered(session, 1);
  material.alpha_mode = AlphaMode::opaque;
  session.set_material(mesh.material, material);
  rendered(session, 1);
  material.alpha_mode = AlphaMode::blend;
  material.cull_back_faces = true;
  session.set_material(mesh.material, material);
  rendered(session, 1);
  session.remove(first);
  return rendered(session, 2);
}

TEST(AccelChoiceOfSession, FollowsEdits) {
  EXPECT_LE(different_pixels(edited(AccelChoice::embree), edited(AccelChoice::bvh)), kFewPixels);
}

TEST(AccelChoiceOfSession, ContinuesFromCheckpoints) {
  const TempFolder folder;
  const Scene scene = find_builtin_scene("turntable")->build();
  RenderSettings settings = settings_with(AccelChoice::bvh);
  Session through(scene, settings);
  rendered(through, 2);
  through.set_time(0.3f);
  rendered(through, 1);
  through.save_checkpoint(folder / "state");
  Session resumed(scene, settings);
  resumed.load_checkpoint(folder / "state");
  EXPECT_EQ(different_pixels(rendered(through, 2), rendered(resumed, 2)), 0u);
}

TEST(AccelChoiceOfSession, NeedsANewSession) {
  Session session(find_builtin_scene("cornell")->build(), settings_with(AccelChoice::embree));
  EXPECT_FALSE(session.set_settings(settings_with(AccelChoice::bvh)));
}

}  // namespace
}  // namespace relume
