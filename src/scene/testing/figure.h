// A tube bent by joints, for tests of motion.
#pragma once

#include <cmath>

#include <glm/gtc/matrix_transform.hpp>

#include "scene/scene.h"

namespace relume::testing {

struct FigureOptions {
  int joints = 5;
  int rings = 24;     ///< of vertices along the tube
  int segments = 12;  ///< around the tube
  bool morphs = false;
  bool skinned = true;
  float swing_rad = 0.5f;  ///< of each joint relative to the one below it, at the end of the animation
  int parts = 1;           ///< meshes, one tube each
  int influences = 2;      ///< per vertex; those above two have zero weight
};

/// A tube of length 2 and radius 0.2 that stands on the plane y = 0.
inline Mesh tube(const FigureOptions& o) {
  Mesh mesh;
  mesh.name = "tube";
  mesh.influences_per_vertex = o.skinned ? o.influences : 0;
  for (int r = 0; r < o.rings; ++r) {
    const float along = static_cast<float>(r) / static_cast<float>(o.rings - 1);
    const float joint = along * static_cast<float>(o.joints - 1);
    const int lower = std::min(static_cast<int>(joint), std::max(o.joints - 2, 0));
    const float upper_share = o.joints > 1 ? joint - static_cast<float>(lower) : 0.0f;
    for (int s = 0; s < o.segments; ++s) {
      const float angle = 2 * kPi * static_cast<float>(s) / static_cast<float>(o.segments);
      const Vec3 out(std::cos(angle), 0, std::sin(angle));
      mesh.positions.push_back(0.2f * out + Vec3(0, 2 * along, 0));
      mesh.normals.push_back(out);
      mesh.tangents.emplace_back(0, 1, 0, s % 2 == 0 ? 1 : -1);
      mesh.uv0.emplace_back(static_cast<float>(s) / static_cast<float>(o.segments), along);
      if (!o.skinned) continue;
      mesh.influences.push_back({static_cast<uint32_t>(lower), 1 - upper_share});
      mesh.influences.push_back({static_cast<uint32_t>(std::min(lower + 1, o.joints - 1)), upper_share});
      mesh.influences.resize(mesh.positions.size() * static_cast<size_t>(o.influences));
    }
  }
  const auto vertex = [&](int ring, int segment) {
    return static_cast<uint32_t>(ring * o.segments + segment % o.segments);
  };
  for (int r = 0; r + 1 < o.rings; ++r) {
    for (int s = 0; s < o.segments; ++s) {
      mesh.triangles.emplace_back(vertex(r, s), vertex(r + 1, s), vertex(r, s + 1));
      mesh.triangles.emplace_back(vertex(r, s + 1), vertex(r + 1, s), vertex(r + 1, s + 1));
    }
  }
  return mesh;
}

/// Thickens the tube, more towards the top.
inline MorphTarget thicker(const Mesh& tube) {
  MorphTarget target;
  target.name = "thicker";
  for (size_t i = 0; i < tube.positions.size(); ++i) {
    target.positions.push_back(0.1f * tube.positions[i].y * tube.normals[i]);
    target.normals.push_back(Vec3(0, -0.1f, 0));
    target.tangents.push_back(0.1f * tube.normals[i]);
  }
  return target;
}

/// A scene of the tube with one clip of a second. Its joints bend it and, if it morphs, it thickens. Node 0 has the
/// mesh; the joints follow.
inline Scene figure(const FigureOptions& o = {}) {
  Scene scene;
  scene.name = "figure";
  scene.clips = {"bend"};
  scene.materials.emplace_back();
  scene.meshes.push_back(tube(o));
  scene.meshes[0].material = 0;
  if (o.morphs) scene.meshes[0].morph_targets = {thicker(scene.meshes[0])};
  Node body;
  body.name = "body";
  body.meshes = {0};
  for (int part = 1; part < o.parts; ++part) {
    body.meshes.push_back(part);
    scene.meshes.push_back(scene.meshes[0]);
  }
  scene.add_node(body);
  if (o.morphs)
    scene.animation.push_back(
        {0, AnimatedProperty::morph_weight, Interpolation::linear, {0, 1}, {Vec4(0), Vec4(1)}, 0, 0});
  if (!o.skinned) return scene;
  scene.nodes[0].skin = 0;
  Skin& skin = scene.skins.emplace_back();
  const float length = o.joints > 1 ? 2.0f / static_cast<float>(o.joints - 1) : 0.0f;
  for (int j = 0; j < o.joints; ++j) {
    Node joint;
    joint.name = "joint " + std::to_string(j);
    joint.parent = j == 0 ? kNone : static_cast<Index>(j);
    joint.transform.translation = Vec3(0, j == 0 ? 0.0f : length, 0);
    skin.joints.push_back(scene.add_node(joint));
    skin.inverse_bind.push_back(glm::translate(Mat4(1), Vec3(0, -length * static_cast<float>(j), 0)));
    const Vec4 turned(0, 0, std::sin(0.5f * o.swing_rad), std::cos(0.5f * o.swing_rad));
    scene.animation.push_back({skin.joints.back(),
                               AnimatedProperty::rotation,
                               Interpolation::linear,
                               {0, 1},
                               {Vec4(0, 0, 0, 1), turned},
                               0,
                               0});
  }
  return scene;
}

}  // namespace relume::testing
