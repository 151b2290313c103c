// A scene of one plate, for tests.
#pragma once

#include <functional>
#include <string>

#include "relume/error.h"
#include "scene/scene.h"

namespace relume::testing {

/// A square plate of `material` at the origin, and a camera in front of it.
inline Scene plate(const Material& material = {}) {
  Scene scene;
  scene.name = "plate";
  scene.materials.push_back(material);
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  mesh.material = 0;
  scene.meshes.push_back(mesh);
  Node node;
  node.meshes = {0};
  scene.add_node(node);
  scene.cameras.push_back({.name = "eye"});
  Node eye;
  eye.camera = 0;
  eye.transform.translation = Vec3(0, 0, 3);
  scene.add_node(eye);
  return scene;
}

inline void animate_scale(Scene& scene, Index node, const Vec3& first, const Vec3& last) {
  scene.animation.push_back(
      {node, AnimatedProperty::scale, Interpolation::linear, {0, 1}, {Vec4(first, 0), Vec4(last, 0)}});
}

/// Message of the Error thrown by `action`; empty if none is thrown.
inline std::string problem_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}

}  // namespace relume::testing
