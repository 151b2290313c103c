// A corridor with three bends. The camera is in the first leg and the only lamp in the last. Light needs three
// reflections to reach walls in view.
#include "builtin_scenes/builder.h"
#include "builtin_scenes/rooms.h"
#include "builtin_scenes/scenes.h"
#include "builtin_scenes/shapes.h"

namespace relume {
namespace {

/// One letter per leg, in the order of the camera path.
const FloorPlan kPlan{{"########",  //
                       "#dddc###",  //
                       "####c###",  //
                       "####bba#",  //
                       "######a#",  //
                       "######a#",  //
                       "######a#",  //
                       "########"},
                      2.5f,
                      2.8f};

void add_furniture(SceneBuilder& builder) {
  const Index wood = builder.add_material(glossy("wood", {0.45f, 0.28f, 0.15f}, 0.4f));
  const Index cloth = builder.add_material(matte("cloth", {0.2f, 0.32f, 0.55f}));
  Mesh bench = box({-0.2f, 0.42f, -0.8f}, {0.2f, 0.48f, 0.8f});
  append(bench, box({-0.18f, -0.01f, -0.7f}, {0.18f, 0.42f, -0.62f}));
  append(bench, box({-0.18f, -0.01f, 0.62f}, {0.18f, 0.42f, 0.7f}));
  Transform transform;
  transform.translation = kPlan.middle(4, 6, 0) + Vec3(-0.95f, 0, 0);
  builder.add("bench", std::move(bench), wood, transform);
  transform.translation += Vec3(0, 0.48f, 0.3f);
  builder.add("cushion", box({-0.18f, 0, -0.2f}, {0.18f, 0.1f, 0.2f}), cloth, transform);

  const Index clay = builder.add_material(matte("clay", {0.6f, 0.33f, 0.22f}));
  const std::vector<Vec2> pot = {{0, 0}, {0.16f, 0}, {0.26f, 0.25f}, {0.22f, 0.5f}, {0.16f, 0.62f}, {0.2f, 0.7f}};
  transform.translation = kPlan.middle(3, 6, -0.005f) + Vec3(0.7f, 0, -0.7f);
  Mesh vase = lathe(pot, 48);
  append(vase, transformed(disc(0.2f, 48), translation({0, 0.7f, 0})));
  builder.add("vase", std::move(vase), clay, transform);
}

}  // namespace

Scene build_corridor() {
  SceneBuilder builder("corridor");
  const Index floor = builder.add_material(glossy("floor", {0.58f, 0.53f, 0.47f}, 0.5f));
  const Index white = builder.add_material(matte("ceiling", Rgb(0.85f)));
  builder.add("floor", plan_floor(kPlan), floor);
  builder.add("ceiling", plan_ceiling(kPlan), white);
  const std::pair<char, Rgb> legs[] = {{'a', {0.82f, 0.8f, 0.76f}},
                                       {'b', {0.82f, 0.68f, 0.52f}},
                                       {'c', {0.82f, 0.82f, 0.79f}},
                                       {'d', {0.7f, 0.8f, 0.84f}}};
  for (const auto& [mark, albedo] : legs) {
    const std::string name = std::string("walls ") + mark;
    builder.add(name, plan_walls(kPlan, mark), builder.add_material(matte(name, albedo)));
  }
  add_furniture(builder);

  const Index light = builder.add_material(emitter("lamp", {6000, 5500, 4800}));
  builder.add("lamp", quad(kPlan.middle(1, 1, kPlan.height - 0.02f) - Vec3(1.0f, 0, 0.6f), {2.0f, 0, 0}, {0, 0, 1.2f}),
              light);

  const auto eye = [](int row, int column) { return kPlan.middle(row, column, 1.6f); };
  const Vec3 start = eye(6, 6) + Vec3(0.3f, 0, 0.9f);
  const Vec3 first_bend = eye(3, 6) + Vec3(-0.4f, -0.35f, 0);
  const Index camera = builder.add_camera(start, first_bend, 60);
  builder.add_camera_path(camera, {{0, start, first_bend},
                                   {2.5f, eye(4, 6), eye(3, 5)},
                                   {4, eye(3, 5) + Vec3(0.6f, 0, 0), eye(3, 3)},
                                   {5.5f, eye(3, 4), eye(1, 4)},
                                   {7, eye(2, 4), eye(1, 3)},
                                   {9, eye(1, 3) + Vec3(0.6f, 0, 0), eye(1, 0)}});
  return builder.take();
}

}  // namespace relume
