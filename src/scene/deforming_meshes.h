// The meshes of a compiled scene whose shape skins or morph targets change from frame to frame.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/box.h"
#include "scene/deformation.h"
#include "scene/scene.h"

namespace relume {

/// Whether a skin or morph targets deform this mesh of the node.
bool is_deformable(const Node& node, const Mesh& mesh);

/// Whether the skin of the node deforms this mesh of it.
inline bool is_skinned(const Node& node, const Mesh& mesh) {
  return node.skin != kNone && mesh.influences_per_vertex > 0;
}

/// For each skin, one matrix a joint: from the space of the mesh at rest to the world.
using JointMatrices = std::vector<std::vector<Mat4>>;

/// `world`: one matrix a node. In double precision inside: the inverse bind matrix cancels most of the node's.
JointMatrices joint_matrices(const Scene& scene, std::span<const Mat4> world);

/// Throws Error if a joint is moved or scaled beyond kMaxCoordinate, or if its matrix is not finite.
void check_joints(const Scene& scene, const JointMatrices& joints);

/// Whether a skin mirrors the meshes that it deforms: most of its joints do.
bool mirrors(const std::vector<Mat4>& joints);

/// A node's mesh with the shape that it has at `time_s`, without skin and morph targets: in the world if it is skinned,
/// else in its own space.
Mesh deformed_mesh(const Scene& scene, Index node, const Mesh& mesh, const JointMatrices& joints, float time_s);

/// Bounds of the same.
Box deformed_box(const Scene& scene, Index node, const Mesh& mesh, const JointMatrices& joints, float time_s);

class DeformingMeshes {
 public:
  /// The mesh of a node, and its copy among the arrays of the compiled scene.
  struct Source {
    Index node;
    Index mesh;  ///< of the scene
    uint32_t compiled_mesh;
    uint32_t first_vertex;
    uint32_t vertex_count;
  };

  /// Keeps the rest pose of the mesh. Returns its number here. `scene` has only the channels that play.
  uint32_t add(const Scene& scene, const Source& source);
  uint32_t size() const { return static_cast<uint32_t>(meshes_.size()); }
  const Source& source(uint32_t number) const { return meshes_[number].source; }

  /// From now on only these numbers are updated.
  void keep(const std::vector<bool>& used);

  /// Bounds of the mesh for these joints and any weights of its morph targets: in the world if it is skinned, else in
  /// its own space.
  Box box(uint32_t number, const JointMatrices& joints) const;

  /// Moves the vertices of every mesh whose joints or weights have changed. Returns the numbers of these meshes.
  std::vector<uint32_t> update(const Scene& scene, const JointMatrices& joints, float time_s,
                               std::vector<Vertex>& vertices);

  size_t memory_bytes() const;

 private:
  /// One mesh: its rest pose and its pose now.
  struct Deforming {
    Source source;
    std::shared_ptr<const Mesh> rest;
    Index skin;
    std::vector<Box> joint_boxes;  ///< of the vertices that each joint influences, for any weights; unskinned: one
    std::vector<MorphTargetView> targets;
    std::vector<Affine> joints;
    bool posed = false;
    bool used = true;

    DeformableMesh view() const;
  };

  std::shared_ptr<const Mesh> rest_pose(const Scene& scene, Index mesh);
  /// Returns whether the pose differs from the one before.
  static bool update_pose(const Scene& scene, const JointMatrices& joints, float time_s, Deforming& mesh);

  std::vector<Deforming> meshes_;
};

}  // namespace relume
