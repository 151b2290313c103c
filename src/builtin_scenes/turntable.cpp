// A round floor inside a round wall, and a lamp that rotates below the floor. All light on the floor comes from the
// bright part of the wall, which moves around once in ten seconds.
#include <cmath>
#include <vector>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/scenes.h"
#include "builtin_scenes/shapes.h"

namespace relume {

Scene build_turntable() {
  SceneBuilder builder("turntable");
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

  const Index light = builder.add_material(emitter("lamp", {110, 99, 80}));
  const Index arm = builder.add_group("turning arm");
  // Faces outwards and 20 degrees up, past the floor's edge.
  const Mat4 pose = translation({1.3f, -0.75f, 0}) * rotation(20, Vec3(0, 0, 1));
  builder.add("lamp", transformed(quad({0, -0.35f, 0.4f}, {0, 0, -0.8f}, {0, 0.7f, 0}), pose), light, {}, arm);
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

}  // namespace relume
