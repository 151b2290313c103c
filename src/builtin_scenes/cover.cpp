// A knot of more than a million triangles under ten lamps in a hood with a grille at the bottom. The receiver is
// intricate, and every lamp is partly occluded from nearly everywhere.
#include "builtin_scenes/builder.h"
#include "builtin_scenes/scenes.h"
#include "builtin_scenes/shapes.h"

namespace relume {
namespace {

constexpr float kHalfX = 2.4f;
constexpr float kHalfZ = 1.4f;
constexpr float kGrille = 3.9f;  // height above the floor
constexpr float kTop = 4.9f;

Mesh hood() {
  Mesh mesh;
  const float t = 0.05f;
  append(mesh, box({-kHalfX - t, kGrille, -kHalfZ - t}, {-kHalfX, kTop, kHalfZ + t}));
  append(mesh, box({kHalfX, kGrille, -kHalfZ - t}, {kHalfX + t, kTop, kHalfZ + t}));
  append(mesh, box({-kHalfX, kGrille, -kHalfZ - t}, {kHalfX, kTop, -kHalfZ}));
  append(mesh, box({-kHalfX, kGrille, kHalfZ}, {kHalfX, kTop, kHalfZ + t}));
  append(mesh, box({-kHalfX - t, kTop, -kHalfZ - t}, {kHalfX + t, kTop + t, kHalfZ + t}));
  return mesh;
}

Mesh grille() {
  constexpr float kPitch = 0.2f;
  constexpr float kHalfBar = 0.035f;
  Mesh mesh;
  for (int i = -11; i <= 11; ++i) {
    const float x = kPitch * static_cast<float>(i);
    append(mesh, box({x - kHalfBar, kGrille, -kHalfZ}, {x + kHalfBar, kGrille + 0.05f, kHalfZ}));
  }
  for (int i = -6; i <= 6; ++i) {
    const float z = kPitch * static_cast<float>(i);
    append(mesh, box({-kHalfX, kGrille + 0.06f, z - kHalfBar}, {kHalfX, kGrille + 0.11f, z + kHalfBar}));
  }
  return mesh;
}

void add_lamps(SceneBuilder& builder) {
  const Index warm = builder.add_material(emitter("warm lamps", {190, 148, 96}));
  const Index cold = builder.add_material(emitter("cold lamps", {116, 144, 190}));
  Mesh lamps[2];
  for (int i = 0; i < 10; ++i) {
    const Vec3 middle(-1.8f + 0.9f * static_cast<float>(i % 5), kTop - 0.15f, i < 5 ? -0.65f : 0.65f);
    append(lamps[i % 2], quad(middle - Vec3(0.18f, 0, 0.18f), {0.36f, 0, 0}, {0, 0, 0.36f}));
  }
  builder.add("warm lamps", std::move(lamps[0]), warm);
  builder.add("cold lamps", std::move(lamps[1]), cold);
}

}  // namespace

Scene build_cover() {
  SceneBuilder builder("cover");
  const Index grey = builder.add_material(matte("floor and wall", {0.55f, 0.54f, 0.52f}));
  const Index steel = builder.add_material(metal("steel", {0.55f, 0.56f, 0.58f}, 0.45f));
  const Index jade = builder.add_material(glossy("jade", {0.32f, 0.55f, 0.38f}, 0.25f));
  builder.add("floor", quad({-7, 0, 6}, {14, 0, 0}, {0, 0, -10}), grey);
  builder.add("wall", quad({-7, 0, -4}, {14, 0, 0}, {0, 7, 0}), grey);
  builder.add("hood", hood(), steel);
  builder.add("grille", grille(), steel);
  builder.add(
      "knot",
      transformed(torus_knot(2, 3, 1.0f, 0.33f, 4096, 132), translation({0, 1.75f, 0}) * rotation(62, Vec3(1, 0, 0))),
      jade);
  builder.add("plinth", transformed(cylinder(1.1f, 0.3f, 96, true), translation({0, -0.01f, 0})), grey);
  add_lamps(builder);
  builder.add_camera({-3.6f, 2.5f, 6.4f}, {0, 2.2f, 0}, 42);
  return builder.take();
}

}  // namespace relume
