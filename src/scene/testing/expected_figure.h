// Expected vertices of testing::figure().
#pragma once

#include <vector>

#include <glm/gtc/matrix_transform.hpp>

#include "scene/testing/figure.h"

namespace relume::testing {

/// Joint matrices of figure(o) at `time_s`, from rest positions to the world, in double precision.
inline std::vector<glm::dmat4> expected_joints(const FigureOptions& o, const Scene& scene, double time_s) {
  std::vector<glm::dmat4> joints;
  const double length = 2.0 / (o.joints - 1);
  glm::dmat4 world(1);
  for (int j = 0; j < o.joints; ++j) {
    const Transform& t = scene.nodes[static_cast<size_t>(j) + 1].transform;
    world = glm::translate(world, glm::dvec3(t.translation));
    world = glm::rotate(world, static_cast<double>(o.swing_rad) * time_s, glm::dvec3(0, 0, 1));
    world = glm::scale(world, glm::dvec3(t.scale));
    joints.push_back(glm::translate(world, glm::dvec3(0, -length * j, 0)));
  }
  return joints;
}

/// A vertex of figure(o) from the definition.
struct ExpectedVertex {
  glm::dvec3 position;
  glm::dvec3 normal;
  glm::dvec3 tangent;
};

inline ExpectedVertex expected_vertex(const FigureOptions& o, const Scene& scene, uint32_t v, double time_s) {
  const Mesh& mesh = scene.meshes[0];
  ExpectedVertex e{glm::dvec3(mesh.positions[v]), glm::dvec3(mesh.normals[v]), glm::dvec3(Vec3(mesh.tangents[v]))};
  if (o.morphs) {
    e.position += time_s * glm::dvec3(mesh.morph_targets[0].positions[v]);
    e.normal += time_s * glm::dvec3(mesh.morph_targets[0].normals[v]);
    e.tangent += time_s * glm::dvec3(mesh.morph_targets[0].tangents[v]);
  }
  if (o.skinned) {
    const std::vector<glm::dmat4> joints = expected_joints(o, scene, time_s);
    glm::dmat4 sum(0);
    for (size_t k = 0; k < 2; ++k) {
      const JointInfluence& influence = mesh.influences[2 * size_t{v} + k];
      sum += static_cast<double>(influence.weight) * joints[influence.joint];
    }
    const glm::dmat3 linear(sum);
    e.position = glm::dvec3(sum * glm::dvec4(e.position, 1));
    e.normal = glm::transpose(glm::inverse(linear)) * e.normal;
    e.tangent = linear * e.tangent;
  }
  e.normal = glm::normalize(e.normal);
  e.tangent = glm::normalize(e.tangent);
  return e;
}

/// The figure stopped at 0.5 s.
inline Scene stopped_figure(const FigureOptions& o) {
  Scene scene = figure(o);
  scene.animation.clear();
  const glm::quat turn = glm::angleAxis(0.5f * o.swing_rad, Vec3(0, 0, 1));
  for (size_t i = 1; i < scene.nodes.size(); ++i) scene.nodes[i].transform.rotation = turn;
  if (o.morphs) scene.nodes[0].morph_weights = {0.5f};
  return scene;
}

}  // namespace relume::testing
