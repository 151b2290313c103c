// Meshes of a compiled scene whose shape changes from frame to frame by skins or morph targets.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "core/array.h"
#include "core/box.h"
#include "scene/scene.h"
#include "scene/scene_launcher.h"

namespace relume {

/// Whether a skin or morph targets deform this mesh of the node.
bool is_deformable(const Node& node, const Mesh& mesh);

/// Whether the skin of the node deforms this mesh of the node.
inline bool is_skinned(const Node& node, const Mesh& mesh) {
  return node.skin != kNone && mesh.influences_per_vertex > 0;
}

/// Per skin, one matrix per joint: from the rest pose in mesh space to the world.
using JointMatrices = std::vector<std::vector<Mat4>>;

/// `world`: one matrix per node. Double precision inside: the inverse bind matrix cancels most of the node's.
JointMatrices joint_matrices(const Scene& scene, std::span<const Mat4> world);

/// Throws Error if a joint is moved or scaled beyond kMaxCoordinate, or if its matrix is not finite.
void check_joints(const Scene& scene, const JointMatrices& joints);

/// Whether a skin mirrors its meshes, judged by the majority of its joints.
bool mirrors(const std::vector<Mat4>& joints);

/// Mesh of a node in its shape at `time_s`, without skin and morph targets. In world space if skinned, else in mesh
/// space.
Mesh deformed_mesh(const Scene& scene, Index node, const Mesh& mesh, const JointMatrices& joints, float time_s);

/// Bounds of deformed_mesh().
Box deformed_box(const Scene& scene, Index node, const Mesh& mesh, const JointMatrices& joints, float time_s);

/// Joints and time at one key of an open shutter.
struct ShutterPose {
  JointMatrices joints;
  float time_s = 0;
};

class DeformingMeshes {
 public:
  /// `memory`: for the data of kernels; it must outlive this.
  explicit DeformingMeshes(Memory& memory = host_memory()) : memory_(&memory) {}

  /// The mesh of a node, and its copy among the arrays of the compiled scene.
  struct Source {
    Index node;
    Index mesh;  ///< of the scene
    uint32_t compiled_mesh;
    uint32_t first_vertex;
    uint32_t vertex_count;
  };

  /// Stores the rest pose of the mesh. Returns its index here. `scene` has only the playing channels.
  uint32_t add(const Scene& scene, const Source& source);
  uint32_t size() const { return static_cast<uint32_t>(meshes_.size()); }
  const Source& source(uint32_t number) const { return meshes_[number].source; }

  /// Keeps only the used meshes for further updates.
  void keep(const std::vector<bool>& used);

  /// Bounds of the mesh for these joints and any weights of its morph targets. In world space if skinned, else in mesh
  /// space.
  Box box(uint32_t number, const JointMatrices& joints) const;

  /// Updates the vertices of every mesh whose joints or weights have changed. Returns the indices of these meshes.
  /// `vertices`: of the compiled scene.
  std::vector<uint32_t> update(const Scene& scene, const JointMatrices& joints, float time_s, View<Vertex> vertices,
                               SceneLauncher& launcher);

  /// Writes the vertices of a mesh at the keys of an open shutter, one key after the other. The middle key is the
  /// present pose, which stays. Returns whether the keys differ. `vertices`: vertex_count for each pose.
  bool pose_keys(uint32_t number, const Scene& scene, std::span<const ShutterPose> poses, View<Vertex> vertices,
                 SceneLauncher& launcher);

  size_t memory_bytes() const;

 private:
  /// A mesh at rest.
  struct RestPose {
    RestPose(const Mesh& mesh, Memory& memory);
    size_t memory_bytes() const;

    Array<Vec3> positions;
    Array<Vec3> normals;
    Array<Vec4> tangents;
    Array<JointInfluence> influences;
    uint32_t influences_per_vertex;
    Array<Vec3> displacements;             ///< of all morph targets
    std::vector<MorphTargetData> targets;  ///< with weight 0
  };
  /// One mesh: its rest pose and its current pose.
  struct Deforming {
    explicit Deforming(Memory& memory) : targets(memory), joints(memory) {}
    DeformableMesh view() const;

    Source source;
    std::shared_ptr<const RestPose> rest;  ///< shared by the nodes of a mesh
    Index skin;
    std::vector<Box> joint_boxes;  ///< of the vertices influenced by each joint, for any weights; unskinned: one box
    Array<MorphTargetData> targets;
    Array<Affine> joints;
    bool posed = false;  ///< whether the vertices follow `targets` and `joints`
    bool used = true;
  };

  std::shared_ptr<const RestPose> rest_pose(const Scene& scene, Index mesh);
  /// Returns whether the pose differs from the previous one. Clears `posed`, which the caller sets.
  static bool update_pose(const Scene& scene, const JointMatrices& joints, float time_s, Deforming& mesh);

  Memory* memory_;
  std::vector<Deforming> meshes_;
};

}  // namespace relume
