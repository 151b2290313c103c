#include <iostream>

#include <scene/scene.h>

int main() {
  relume::Scene scene;
  const relume::Index parent = scene.add_node({.name = "parent", .transform = {.translation = {1, 2, 3}}});
  scene.add_node({.name = "child", .parent = parent, .transform = {.translation = {0, 0, 4}}});
  relume::validate(scene, "package test");
  const relume::Vec3 p = relume::transform_point(relume::world_matrices(scene, 0.0f)[1], {0, 0, 0});
  std::cout << p.x << ' ' << p.y << ' ' << p.z << '\n';
  return p == relume::Vec3(1, 2, 7) ? 0 : 1;
}
