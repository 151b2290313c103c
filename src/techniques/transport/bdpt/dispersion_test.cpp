// Agreement of all estimators on the colours behind dispersive interfaces.
#include <gtest/gtest.h>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/shapes.h"
#include "techniques/transport/bdpt/testing/image_mean.h"

namespace relume::testing {
namespace {

constexpr int kSamples = 512;
constexpr float kInside = 0.6f;  ///< angle of the light to the normal, inside the medium
constexpr float kRed = 0.95f;    ///< exit angle of red; blue is reflected totally

/// Direction in the plane z = 0 at an angle to +Y.
Vec3 at_angle(float angle) { return {std::sin(angle), std::cos(angle), 0}; }

/// Square about `center` that faces a direction at an angle to +Y.
Mesh facing(const Vec3& center, float angle, float size) {
  const Vec3 across = Vec3(std::cos(angle), -std::sin(angle), 0) * size;
  const Vec3 along(0, 0, size);
  return quad(center - 0.5f * (across + along), along, across);
}

/// A window of frosted glass in an opaque plane. A lamp inside the medium below lights a screen through it. Red and
/// blue arrive at different positions.
Scene lamp_below_window() {
  SceneBuilder b("window");
  Material frosted = glass("frosted", 1.5f);
  frosted.roughness = 0.2f;
  frosted.dispersion = 20;
  b.add("window", facing(Vec3(0), 0, 0.4f), b.add_material(frosted));
  const Index black = b.add_material(matte("black", Rgb(0)));
  for (const float side : {-1.0f, 1.0f}) {
    b.add("beside", facing({side * 1.2f, 0, 0}, 0, 2), black);
    b.add("beyond", facing({0, 0, side * 1.2f}, 0, 2), black);
  }
  b.add("screen", facing(0.7f * at_angle(kRed), kRed + kPi, 0.8f), b.add_material(matte("screen", Rgb(0.8f))));
  Scene scene = b.take();
  scene.lights.push_back({"lamp", PunctualType::spot, Rgb(10), 0.1f, 0.13f});
  Node lamp;
  lamp.transform = look_at(-1.5f * at_angle(kInside), Vec3(0));
  lamp.light = 0;
  scene.add_node(std::move(lamp));
  return scene;
}

void look(Scene& scene, const Vec3& eye, const Vec3& target, float fov_y_rad, float lens_radius) {
  Camera camera;
  camera.fov_y_rad = fov_y_rad;
  camera.lens_radius = lens_radius;
  camera.focus_distance = glm::length(target - eye);
  scene.cameras.push_back(camera);
  Node node;
  node.camera = 0;
  node.transform = look_at(eye, target);
  scene.add_node(std::move(node));
}

/// Compares all pairs of estimators. Without wavelength weights, all channels would be equal.
void expect_colors_to_agree(const Scene& scene, const std::string& name) {
  const ImageMean both = mean_of(scene, {}, kSamples);
  const ImageMean from_light = mean_of(scene, {.light_only = true}, kSamples);
  const ImageMean from_camera = mean_of(scene, kCameraAlone, kSamples);
  EXPECT_LT(both.value.b / both.value.r, 0.3) << name;
  EXPECT_LT(std::sqrt(both.variance.r) / both.value.r, 0.03) << name;
  expect_same_mean(both, from_light, name + ", light alone");
  expect_same_mean(both, from_camera, name + ", camera alone");
}

TEST(BdptDispersion, EstimatorsAgreeOnAScreen) {
  for (const float lens_radius : {0.0f, 0.2f}) {
    Scene scene = lamp_below_window();
    look(scene, {-0.4f, 1.0f, 0}, 0.7f * at_angle(kRed), 0.06f, lens_radius);
    expect_colors_to_agree(scene, lens_radius > 0 ? "lens" : "pinhole");
  }
}

TEST(BdptDispersion, EstimatorsAgreeOnAnInterface) {
  Scene scene = lamp_below_window();
  scene.meshes.back().triangles = {};  // no screen
  look(scene, at_angle(kRed), {0, 0, 0}, 0.1f, 0.05f);
  expect_colors_to_agree(scene, "interface");
}

}  // namespace
}  // namespace relume::testing
