// The Cornell box (Goral et al. 1984) and its variants: a cube of 5.5 m about the y axis, open towards +Z.
#include <cmath>
#include <vector>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/scenes.h"
#include "builtin_scenes/shapes.h"

namespace relume {
namespace {

constexpr float kHalf = 2.75f;
constexpr float kSize = 2 * kHalf;
constexpr Rgb kWhite{0.73f, 0.73f, 0.73f};
constexpr Rgb kRed{0.63f, 0.065f, 0.05f};
constexpr Rgb kGreen{0.14f, 0.45f, 0.091f};
/// Flux of the lamps divided by π, W/sr. All boxes are equally bright, independent of the lamp's size.
constexpr Rgb kLampPower{23.2f, 17.1f, 8.2f};

Mesh back_wall() { return quad({-kHalf, 0, -kHalf}, {kSize, 0, 0}, {0, kSize, 0}); }

/// Adds floor, ceiling and side walls from the back to z = `front`; returns the white material.
Index add_walls(SceneBuilder& builder, float front) {
  const Index white = builder.add_material(matte("white", kWhite));
  const Index red = builder.add_material(matte("red", kRed));
  const Index green = builder.add_material(matte("green", kGreen));
  const float depth = front + kHalf;
  builder.add("floor", quad({-kHalf, 0, front}, {kSize, 0, 0}, {0, 0, -depth}), white);
  builder.add("ceiling", quad({-kHalf, kSize, -kHalf}, {kSize, 0, 0}, {0, 0, depth}), white);
  builder.add("left wall", quad({-kHalf, 0, front}, {0, 0, -depth}, {0, kSize, 0}), red);
  builder.add("right wall", quad({kHalf, 0, -kHalf}, {0, 0, depth}, {0, kSize, 0}), green);
  return white;
}

void add_open_box(SceneBuilder& builder) {
  const Index white = add_walls(builder, kHalf);
  builder.add("back wall", back_wall(), white);
}

/// Lamp of width × depth metres, 1 cm under the ceiling's middle.
void add_lamp(SceneBuilder& builder, float width, float depth) {
  const Index light = builder.add_material(emitter("lamp", kLampPower / (width * depth)));
  builder.add("lamp", quad({-width / 2, kSize - 0.01f, -depth / 2}, {width, 0, 0}, {0, 0, depth}), light);
}

/// The classic view: the opening fills a square image.
void add_front_camera(SceneBuilder& builder) { builder.add_camera({0, kHalf, 10.7f}, {0, kHalf, 0}, 39.3f); }

/// Two rotated boxes on the floor, sunk into it by 1 cm.
void add_boxes(SceneBuilder& builder) {
  const Index material = builder.add_material(glossy("boxes", kWhite, 0.35f));
  Transform tall;
  tall.translation = {-0.95f, 0, -0.85f};
  tall.rotation = glm::quat_cast(Mat3(rotation_y(17)));
  builder.add("tall box", box({-0.82f, -0.01f, -0.82f}, {0.82f, 3.3f, 0.82f}), material, tall);
  Transform low;
  low.translation = {0.95f, 0, 0.95f};
  low.rotation = glm::quat_cast(Mat3(rotation_y(-17)));
  builder.add("short box", box({-0.82f, -0.01f, -0.82f}, {0.82f, 1.65f, 0.82f}), material, low);
}

Transform at(const Vec3& position) {
  Transform transform;
  transform.translation = position;
  return transform;
}

/// Height of the water at (x, z): a few waves of different directions.
float wave_height(float x, float z) {
  return 1.3f + 0.035f * std::sin(3.1f * x + 1.3f * z) + 0.025f * std::sin(-2.2f * x + 4.3f * z + 1.0f) +
         0.012f * std::sin(6.3f * x - 5.1f * z + 2.5f) + 0.006f * std::sin(9.7f * x + 8.3f * z);
}

/// The closed boundary of the water. It extends 5 mm into walls and floor, where it is invisible, so that no film of
/// air remains. Its front is a plane just behind the opening.
Mesh water_body() {
  constexpr int kCells = 256;
  const float side = kHalf + 0.005f;
  const float front = kHalf - 0.01f;
  const float bottom = -0.005f;
  const auto skirt = [&](const Vec3& from, const Vec3& to) {
    return flat_shaded(parametric_surface(kCells, 1, [&](float u, float v) {
      const Vec3 p = from + u * (to - from);
      return Vec3(p.x, lerp(bottom, wave_height(p.x, p.z), v), p.z);
    }));
  };
  Mesh top = height_field({-side, -side}, {side, front}, kCells, kCells, wave_height);
  const Vec3 corners[4] = {{-side, 0, front}, {side, 0, front}, {side, 0, -side}, {-side, 0, -side}};
  for (int i = 0; i < 4; ++i) {
    Mesh wall = skirt(corners[i], corners[(i + 1) % 4]);
    const Vec3 along = corners[(i + 1) % 4] - corners[i];
    wall.normals.assign(wall.positions.size(), glm::normalize(glm::cross(along, Vec3(0, 1, 0))));
    append(top, wall);
  }
  append(top, quad({-side, bottom, -side}, {2 * side, 0, 0}, {0, 0, side + front}));
  return top;
}

}  // namespace

Scene build_cornell() {
  SceneBuilder builder("cornell");
  add_open_box(builder);
  add_boxes(builder);
  add_lamp(builder, 1.3f, 1.05f);
  add_front_camera(builder);
  return builder.take();
}

Scene build_cornell_closed() {
  SceneBuilder builder("cornell-closed");
  add_open_box(builder);
  const Index blue = builder.add_material(matte("blue", {0.2f, 0.3f, 0.55f}));
  builder.add("front wall", quad({kHalf, 0, kHalf}, {-kSize, 0, 0}, {0, kSize, 0}), blue);
  add_boxes(builder);
  add_lamp(builder, 1.3f, 1.05f);
  // Turns by 100 degrees in ten seconds, as in the measurements of [Schalk18 §4.3].
  const Vec3 eye(1.9f, 2.9f, 2.2f);
  std::vector<CameraKey> keys;
  for (int i = 0; i <= 10; ++i) {
    const float angle = glm::radians(-32.0f - 10.0f * static_cast<float>(i));
    keys.push_back({static_cast<float>(i), eye, eye + Vec3(std::sin(angle), -0.15f, -std::cos(angle))});
  }
  const Index camera = builder.add_camera(keys.front().eye, keys.front().target, 60);
  builder.add_camera_path(camera, keys);
  return builder.take();
}

Scene build_cornell_spheres() {
  SceneBuilder builder("cornell-spheres");
  add_open_box(builder);
  const Index mirror = builder.add_material(metal("mirror", Rgb(0.9f), 0));
  const Index clear = builder.add_material(glass("glass", 1.5f));
  builder.add("mirror sphere", icosphere(1.0f, 5), mirror, at({-1.25f, 1.0f, -0.9f}));
  builder.add("glass sphere", icosphere(1.0f, 5), clear, at({1.2f, 1.005f, 0.75f}));
  add_lamp(builder, 1.3f, 1.05f);
  add_front_camera(builder);
  return builder.take();
}

Scene build_cornell_mirror() {
  SceneBuilder builder("cornell-mirror");
  // The room continues behind the camera; otherwise the mirror would only show the black opening.
  const float front = 11;
  const Index white = add_walls(builder, front);
  builder.add("front wall", quad({kHalf, 0, front}, {-kSize, 0, 0}, {0, kSize, 0}), white);
  const Index mirror = builder.add_material(metal("mirror", Rgb(0.9f), 0));
  builder.add("back wall", back_wall(), mirror);
  builder.add("mirror sphere", icosphere(1.2f, 5), mirror, at({0.6f, 1.2f, -0.2f}));
  add_lamp(builder, 1.3f, 1.05f);
  add_front_camera(builder);
  return builder.take();
}

Scene build_cornell_water() {
  SceneBuilder builder("cornell-water");
  add_open_box(builder);
  const Index water = builder.add_material(glass("water", 1.33f, {0.75f, 0.9f, 0.95f}, 5.0f));
  builder.add("water", water_body(), water);
  const Index stone = builder.add_material(matte("stone", {0.55f, 0.5f, 0.42f}));
  builder.add("stone", icosphere(0.85f, 5), stone, at({-0.9f, 0.7f, -0.6f}));
  add_lamp(builder, 0.15f, 0.15f);
  add_front_camera(builder);
  return builder.take();
}

Scene build_cornell_glass() {
  SceneBuilder builder("cornell-glass");
  add_open_box(builder);
  const Index clear = builder.add_material(glass("glass", 1.5f));
  const Index amber = builder.add_material(glass("amber", 1.5f, {0.9f, 0.5f, 0.12f}, 1.0f));
  builder.add("glass sphere", icosphere(1.0f, 5), clear, at({-0.95f, 1.6f, -0.6f}));
  builder.add("amber sphere", icosphere(0.7f, 5), amber, at({1.25f, 1.1f, 0.7f}));
  add_lamp(builder, 0.15f, 0.15f);
  add_front_camera(builder);
  return builder.take();
}

}  // namespace relume
