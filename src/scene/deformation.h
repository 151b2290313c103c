// Deformation of meshes: morph targets, then linear blend skinning (glTF 2.0, sections 3.7.2.2 and 3.7.3.3).
#pragma once

#include "relume/scene.h"
#include "scene/scene_view.h"

namespace relume {

/// Offset of a morph target that does not displace this attribute.
inline constexpr uint32_t kNoDisplacements = 0xffffffffu;

/// Offsets of a morph target's displacements, one per vertex and attribute, in DeformableMesh::displacements.
struct MorphTargetData {
  uint32_t positions = kNoDisplacements;
  uint32_t normals = kNoDisplacements;
  uint32_t tangents = kNoDisplacements;
  float weight = 0;
};

/// A mesh at rest and its deformation at one time.
struct DeformableMesh {
  View<const Vec3> positions;
  View<const Vec3> normals;   ///< unit; empty: none
  View<const Vec4> tangents;  ///< xyz unit, w = ±1; empty: none
  View<const MorphTargetData> targets;
  View<const Vec3> displacements;         ///< of all targets
  View<const JointInfluence> influences;  ///< influences_per_vertex for each vertex
  uint32_t influences_per_vertex = 0;     ///< 0: no skin
  View<const Affine> joints;              ///< from the rest pose in mesh space to the world
};

/// A deformed vertex: in world space if the mesh has a skin, else in mesh space.
struct DeformedVertex {
  Vec3 position{0};
  Vec3 normal{0, 0, 1};   ///< unit
  Vec3 tangent{1, 0, 0};  ///< unit
};

namespace deformation_detail {

RELUME_HD inline Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
  const float length = glm::length(v);
  return length > 0.0f && is_finite(length) ? v / length : otherwise;
}

/// Adds weight · displacement. `first`: offset of the displacements, or kNoDisplacements.
RELUME_HD inline void displace(Vec3& v, const DeformableMesh& mesh, uint32_t first, uint32_t vertex, float weight) {
  if (first != kNoDisplacements) v += weight * mesh.displacements[first + vertex];
}

/// Σ weight · joint over the joints of a vertex.
RELUME_HD inline Affine blended_joint(const DeformableMesh& mesh, uint32_t vertex) {
  Affine sum{Mat3(0), Vec3(0)};
  for (uint32_t k = 0; k < mesh.influences_per_vertex; ++k) {
    const JointInfluence& influence = mesh.influences[vertex * mesh.influences_per_vertex + k];
    if (influence.weight == 0.0f) continue;
    const Affine& joint = mesh.joints[influence.joint];
    sum.linear += influence.weight * joint.linear;
    sum.translation += influence.weight * joint.translation;
  }
  return sum;
}

}  // namespace deformation_detail

RELUME_HD inline DeformedVertex deform(const DeformableMesh& mesh, uint32_t vertex) {
  using namespace deformation_detail;
  Vec3 position = mesh.positions[vertex];
  Vec3 normal = mesh.normals.empty() ? Vec3(0, 0, 1) : mesh.normals[vertex];
  Vec3 tangent = mesh.tangents.empty() ? Vec3(1, 0, 0) : Vec3(mesh.tangents[vertex]);
  for (const MorphTargetData& target : mesh.targets) {
    if (target.weight == 0.0f) continue;
    displace(position, mesh, target.positions, vertex, target.weight);
    displace(normal, mesh, target.normals, vertex, target.weight);
    displace(tangent, mesh, target.tangents, vertex, target.weight);
  }
  if (mesh.influences_per_vertex > 0) {
    const Affine joint = blended_joint(mesh, vertex);
    // Normals use the inverse transpose, to stay perpendicular under non-uniform scales.
    const Mat3 for_normals = normal_matrix(joint.linear);
    const float mirrored = glm::dot(joint.linear[0], for_normals[0]) < 0.0f ? -1.0f : 1.0f;
    position = joint.point(position);
    normal = for_normals * normal * mirrored;
    tangent = joint.vector(tangent);
  }
  return {position, unit_or(normal, Vec3(0, 0, 1)), unit_or(tangent, Vec3(1, 0, 0))};
}

/// Pass kernel: writes the vertices of one mesh into the array that kernels read. Texture coordinates stay unchanged.
/// Tangents keep their handedness: Instance::orientation marks mirroring skins.
struct DeformVerticesKernel {
  DeformableMesh mesh;
  View<Vertex> vertices;  ///< of this mesh

  RELUME_HD void operator()(uint32_t x, uint32_t) const {
    const DeformedVertex deformed = deform(mesh, x);
    Vertex& vertex = vertices[x];
    vertex.position = deformed.position;
    vertex.normal = pack_normal(deformed.normal, mesh.tangents.empty() ? 1.0f : mesh.tangents[x].w);
    vertex.tangent = mesh.tangents.empty() ? 0 : pack_direction(deformed.tangent);
  }
};

/// Pass kernel: copies the positions of deforming vertices to their previous positions, for motion vectors.
struct StorePreviousPositionsKernel {
  View<const Vertex> vertices;
  View<const uint32_t> deforming;  ///< vertex of each previous position
  View<Vec3> positions;

  RELUME_HD void operator()(uint32_t x, uint32_t) const { positions[x] = vertices[deforming[x]].position; }
};

}  // namespace relume
