// A plate under point lights, some of them hidden: scenes with hard shadows, in which only the choice of lights is
// noisy.
#pragma once

#include "scene/testing/media.h"

namespace relume::testing {

/// Adds a point light of 1 W/sr.
inline void add_point_light(Scene& scene, const Vec3& position) {
  PunctualLight light;
  light.type = PunctualType::point;
  scene.lights.push_back(light);
  Node node;
  node.light = static_cast<Index>(scene.lights.size()) - 1;
  node.transform.translation = position;
  scene.add_node(node);
}

/// Adds a horizontal rectangle around `centre`. Returns its node.
inline Index add_card(Scene& scene, const Vec3& centre, const Vec2& half_size, float albedo = 0) {
  Mesh mesh;
  const Vec2& h = half_size;
  mesh.positions = {{-h.x, 0, -h.y}, {-h.x, 0, h.y}, {h.x, 0, h.y}, {h.x, 0, -h.y}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  add_mesh(scene, matte(Rgb(albedo)), std::move(mesh));
  const auto node = static_cast<Index>(scene.nodes.size()) - 1;
  scene.nodes.back().transform.translation = centre;
  return node;
}

/// A white plate of 6 × 6 m, of which the camera sees the middle square of 2 × 2 m from above, from a height of 0.5 m.
inline Scene bare_plate() { return plate(matte(Rgb(0.8f)), 3, 1); }

/// Two point lights that light all of the visible plate, and two equal ones that no point of it sees. Candidates know
/// the difference only from their shadow rays.
inline Scene half_hidden_lamps() {
  Scene scene = bare_plate();
  for (const float x : {-0.6f, 0.6f}) {
    add_point_light(scene, {x, 2, 0});
    add_point_light(scene, {x, 2, 1.2f});
    add_card(scene, {x, 1.95f, 1.2f}, Vec2(0.3f));
  }
  return scene;
}

/// The same with a card in view, which has depth edges around it, and one above the camera, which casts two shadows.
inline Scene cards_under_lamps() {
  Scene scene = half_hidden_lamps();
  add_card(scene, {0.1f, 0.3f, 0.45f}, {0.35f, 0.25f}, 0.5f);
  add_card(scene, {0, 1, -0.2f}, Vec2(0.14f));
  return scene;
}

}  // namespace relume::testing
