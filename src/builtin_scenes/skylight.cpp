// A closed room with three square holes in its ceiling, of 0.3, 1 and 2 m, under the sky and a sun of 1 degree. Most
// directions from a surface meet the dark ceiling: only guiding and samples of the environment find the holes.
#include <utility>
#include <vector>

#include <glm/trigonometric.hpp>

#include "builtin_scenes/builder.h"
#include "builtin_scenes/rooms.h"
#include "builtin_scenes/scenes.h"
#include "builtin_scenes/shapes.h"

namespace relume {
namespace {

constexpr float kWidth = 12;  // along x
constexpr float kDepth = 7;   // along z
constexpr float kHeight = 3.5f;
constexpr float kWall = 0.2f;  // thickness of walls and ceiling

Opening hole(float x, float z, float size) { return {{x - size / 2, x + size / 2}, {z - size / 2, z + size / 2}}; }

/// A slab over room and walls. It is a wall that lies on its side, so that heights of openings are positions along z.
Mesh ceiling() {
  std::vector<Opening> holes = {hole(2, 4, 0.3f), hole(5, 2.5f, 1), hole(9, 3.5f, 2)};
  for (Opening& opening : holes) opening.along += kWall;  // from the start of the slab
  Mesh mesh = wall({-kWall, 0}, {kWidth + kWall, 0}, kWall, kDepth + kWall, holes);
  mesh = transformed(std::move(mesh), translation({0, kHeight + kWall / 2, 0}) * rotation(90, Vec3(1, 0, 0)));
  append(mesh, box({-kWall, kHeight, -kWall}, {kWidth + kWall, kHeight + kWall, 0}));
  return mesh;
}

Mesh walls() {
  constexpr float kTop = kHeight + kWall / 2;  // within the ceiling
  Mesh mesh = box({-kWall, -0.01f, -kWall}, {0, kTop, kDepth + kWall});
  append(mesh, box({kWidth, -0.01f, -kWall}, {kWidth + kWall, kTop, kDepth + kWall}));
  append(mesh, box({0, -0.01f, -kWall}, {kWidth, kTop, 0}));
  append(mesh, box({0, -0.01f, kDepth}, {kWidth, kTop, kDepth + kWall}));
  return mesh;
}

void add_furniture(SceneBuilder& builder) {
  const Index wood = builder.add_material(glossy("wood", {0.45f, 0.28f, 0.15f}, 0.4f));
  Mesh table = box({3.4f, 0.7f, 3.8f}, {5.4f, 0.76f, 4.8f});
  for (const float x : {3.5f, 5.22f}) {
    for (const float z : {3.9f, 4.62f}) append(table, box({x, -0.01f, z}, {x + 0.08f, 0.7f, z + 0.08f}));
  }
  builder.add("table", std::move(table), wood);
  const Index clay = builder.add_material(matte("clay", {0.6f, 0.33f, 0.22f}));
  builder.add("pillar", transformed(cylinder(0.25f, 2.4f, 48, true), translation({7, -0.01f, 5.2f})), clay);
  builder.add("ball", transformed(icosphere(0.45f, 4), translation({8.6f, 0.44f, 1.6f})),
              builder.add_material(glossy("ball", {0.25f, 0.35f, 0.5f}, 0.3f)));
}

}  // namespace

Scene build_skylight() {
  SceneBuilder builder("skylight");
  const Index plaster = builder.add_material(matte("plaster", {0.72f, 0.7f, 0.66f}));
  builder.add("floor", quad({-kWall, 0, kDepth + kWall}, {kWidth + 2 * kWall, 0, 0}, {0, 0, -kDepth - 2 * kWall}),
              builder.add_material(matte("floor", {0.5f, 0.46f, 0.4f})));
  builder.add("walls", walls(), plaster);
  builder.add("ceiling", ceiling(), builder.add_material(matte("ceiling", {0.6f, 0.6f, 0.58f})));
  add_furniture(builder);

  Environment environment;
  environment.kind = EnvironmentKind::sun_sky;
  environment.sun_sky.sun_elevation_rad = glm::radians(58.0f);
  environment.sun_sky.sun_azimuth_rad = glm::radians(-65.0f);
  environment.sun_sky.sun_angular_diameter_rad = glm::radians(1.0f);
  builder.set_environment(environment);
  builder.add_camera({0.6f, 1.6f, 6.4f}, {7.5f, 1.1f, 2.2f}, 60);
  return builder.take();
}

}  // namespace relume
