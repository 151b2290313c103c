// Plates seen from above with absorbing media around them: scenes with images known in closed form.
#pragma once

#include <utility>

#include "scene/scene.h"

namespace relume::testing {

inline void add_mesh(Scene& scene, const Material& material, Mesh mesh) {
  mesh.material = static_cast<Index>(scene.materials.size());
  scene.materials.push_back(material);
  Node node;
  node.meshes = {static_cast<Index>(scene.meshes.size())};
  scene.meshes.push_back(std::move(mesh));
  scene.add_node(node);
}

/// A camera straight above a square plate of `material` in y = 0 that fills the image. Orthographic, so all pixels see
/// the plate from the same direction.
inline Scene plate(const Material& material, float half_size, float seen) {
  Scene scene;
  scene.name = "plate";
  Mesh mesh;
  const float h = half_size;
  mesh.positions = {{-h, 0, -h}, {-h, 0, h}, {h, 0, h}, {h, 0, -h}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  add_mesh(scene, material, std::move(mesh));
  Camera camera;
  camera.projection = Projection::orthographic;
  camera.half_height = seen;
  scene.cameras.push_back(camera);
  Node eye;
  eye.camera = 0;
  eye.transform.translation = Vec3(0, 0.5f, 0);
  eye.transform.rotation = glm::angleAxis(-kPi / 2, Vec3(1, 0, 0));
  scene.add_node(eye);
  return scene;
}

inline Material matte(const Rgb& albedo) {
  Material m;
  m.base_color = albedo;
  m.metallic = 0;
  m.specular = 0;
  return m;
}

/// Adds an emitting square of 2 m that faces down, 1.5 m above the plate.
inline void add_square_lamp(Scene& scene, const Rgb& emission) {
  Material lamp = matte(Rgb(0));
  lamp.emission = emission;
  Mesh mesh;
  mesh.positions = {{-1, 1.5f, -1}, {1, 1.5f, -1}, {1, 1.5f, 1}, {-1, 1.5f, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  add_mesh(scene, lamp, std::move(mesh));
}

/// A medium that absorbs but neither reflects nor refracts.
inline Material tint(const Rgb& absorption) {
  Material m = matte(Rgb(1));
  m.transmission = 1;
  m.roughness = 0;
  m.ior = 1;
  m.thickness = 1;
  m.attenuation_distance = 1;
  m.attenuation_color = exp(-absorption);
  return m;
}

/// Adds the surface of a slab between two heights; an open sheet if they are equal.
inline void add_slab(Scene& scene, const Material& material, float top, float bottom) {
  Mesh mesh;
  for (const float y : {top, bottom}) {
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (const Vec2& p : {Vec2(-4), Vec2(-4, 4), Vec2(4), Vec2(4, -4)}) mesh.positions.emplace_back(p.x, y, p.y);
    const bool up = first == 0;
    mesh.triangles.emplace_back(first, first + (up ? 1 : 2), first + (up ? 2 : 1));
    mesh.triangles.emplace_back(first, first + (up ? 2 : 3), first + (up ? 3 : 2));
    if (bottom == top) break;
  }
  add_mesh(scene, material, std::move(mesh));
}

/// An emitting plate in y = 0, seen from above, from height `eye`.
inline Scene glowing_plate(float eye) {
  Material material = matte(Rgb(1));
  material.unlit = true;
  Scene scene = plate(material, 3, 1);
  scene.nodes[1].transform.translation.y = eye;
  return scene;
}

}  // namespace relume::testing
