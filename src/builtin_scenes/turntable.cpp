// A round floor inside a round wall, and a lamp that rotates below the floor. All light on the floor comes from the
// bright part of the wall, which moves around once in ten seconds.
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/scenes.h"
#include "builtin_scenes/shapes.h"

namespace relume {
namespace {

/// Adds the lamp's parts to the turning arm.
using AddLamp = void (*)(SceneBuilder& builder, Index arm);

/// A lamp that lights a large part of the wall. It faces outwards and 20 degrees up, past the floor's edge.
void add_wide_lamp(SceneBuilder& builder, Index arm) {
  const Index light = builder.add_material(emitter("lamp", {110, 99, 80}));
  const Mat4 pose = translation({1.3f, -0.75f, 0}) * rotation(20, Vec3(0, 0, 1));
  builder.add("lamp", transformed(quad({0, -0.35f, 0.4f}, {0, 0, -0.8f}, {0, 0.7f, 0}), pose), light, {}, arm);
}

/// A small lamp at the end of a dark tube, in the same direction. With a lamp and an opening of half width a, and a
/// tube of length l, the lit patch has the half width a + 2 a d / l at the distance d from the opening: 0.28 m.
void add_spot_lamp(SceneBuilder& builder, Index arm) {
  constexpr float kHalf = 0.025f;
  constexpr float kOuter = 0.04f;
  constexpr float kLength = 0.6f;
  const Mat4 pose = translation({0.6f, -0.75f, 0}) * rotation(20, Vec3(0, 0, 1));
  const Index light = builder.add_material(emitter("lamp", {2.0e6f, 1.8e6f, 1.45e6f}));
  builder.add("lamp", transformed(quad({0, -kHalf, kHalf}, {0, 0, -2 * kHalf}, {0, 2 * kHalf, 0}), pose), light, {},
              arm);
  Mesh tube = box({-0.02f, -kOuter, -kOuter}, {-0.01f, kOuter, kOuter});
  for (const float side : {-1.0f, 1.0f}) {
    const float low = side < 0 ? -kOuter : kHalf;
    const float high = side < 0 ? -kHalf : kOuter;
    append(tube, box({-0.01f, low, -kOuter}, {kLength, high, kOuter}));
    append(tube, box({-0.01f, -kHalf, low}, {kLength, kHalf, high}));
  }
  builder.add("tube", transformed(std::move(tube), pose), builder.add_material(matte("tube", Rgb(0.02f))), {}, arm);
}

Scene build(std::string name, AddLamp add_lamp) {
  SceneBuilder builder(std::move(name));
  constexpr float kFloorRadius = 2;
  constexpr float kWallRadius = 4;
  constexpr float kBottom = -1.6f;
  const Index floor = builder.add_material(matte("floor", Rgb(0.7f)));
  const Index white = builder.add_material(matte("wall", {0.82f, 0.8f, 0.76f}));
  const Index dark = builder.add_material(matte("bottom", Rgb(0.15f)));
  builder.add("floor", transformed(cylinder(kFloorRadius, 0.08f, 128, true), translation({0, -0.08f, 0})), floor);
  builder.add("wall", flipped(transformed(cylinder(kWallRadius, 5.6f, 128, false), translation({0, kBottom, 0}))),
              white);
  builder.add("bottom", transformed(disc(kWallRadius, 128), translation({0, kBottom, 0})), dark);

  const Index red = builder.add_material(matte("peg", {0.7f, 0.2f, 0.12f}));
  Mesh pegs;
  for (int i = 0; i < 5; ++i) {
    append(pegs, transformed(cylinder(0.09f, 0.5f, 32, true),
                             rotation_y(72.0f * static_cast<float>(i)) * translation({1.2f, -0.01f, 0})));
  }
  builder.add("pegs", std::move(pegs), red);

  const Index arm = builder.add_group("turning arm");
  add_lamp(builder, arm);
  builder.add_turning(arm, 10, 1);

  builder.add_camera({0, 6.2f, 4.0f}, {0, 0, 0.25f}, 44);
  std::vector<CameraKey> keys;
  for (int i = 0; i <= 10; ++i) {  // against the lamp
    const float angle = -0.2f * kPi * static_cast<float>(i);
    keys.push_back({static_cast<float>(i), {3.2f * std::cos(angle), 2.4f, 3.2f * std::sin(angle)}, {0, 0, 0}});
  }
  builder.add_camera_path(builder.add_camera(keys.front().eye, keys.front().target, 60, "round"), keys);
  return builder.take();
}

}  // namespace

Scene build_turntable() { return build("turntable", add_wide_lamp); }

Scene build_turntable_spot() { return build("turntable-spot", add_spot_lamp); }

}  // namespace relume
