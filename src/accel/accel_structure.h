// Acceleration structures: their input, and how a scene updates them.
#pragma once

#include <cstddef>
#include <cstring>
#include <memory>
#include <span>

#include "accel/accel.h"
#include "accel/accel_choice.h"
#include "accel/triangle.h"
#include "core/array.h"
#include "core/key_time.h"
#include "core/vec.h"

namespace relume {

/// Opacity of a point on a triangle, in [0, 1], for alpha masks and blending.
struct OpacityFunction {
  float (*function)(const void* context, uint32_t instance, uint32_t primitive, float u, float v) = nullptr;
  const void* context = nullptr;
};

/// One instance of a triangle mesh.
struct AccelInstance {
  uint32_t mesh = 0;
  Mat4 to_world{1};
  bool in_world_space = true;  ///< vertices are in world space; only a deforming mesh then has an instance node
  bool moves = false;          ///< whether update() may move or hide it
  bool visible = true;         ///< false: rays pass through
  bool mirrored = false;       ///< only in world space: whether its skin mirrors it, which swaps front and back faces
  const Mat4* keys = nullptr;  ///< transforms at the keys of the shutter, none of them singular; nullptr: rests
  uint32_t key_count = 0;      ///< 0 without keys, else at least 2
};

struct AccelMesh {
  const float* positions = nullptr;   ///< the first vertex; all are finite
  size_t position_stride = 0;         ///< bytes
  size_t vertex_count = 0;            ///< vertices of the whole array
  const uint32_t* indices = nullptr;  ///< three per triangle, into the whole array
  size_t triangle_count = 0;
  bool needs_opacity = false;
  bool culls_back_faces = false;         ///< for camera rays
  bool deforms = false;                  ///< whether update() may change its vertices
  bool mirrored = false;                 ///< follows AccelInstance::mirrored
  const float* key_positions = nullptr;  ///< `positions` at the first key of the shutter; nullptr: the shape rests
  size_t key_stride = 0;                 ///< bytes from the vertices of one key to those of the next
  size_t key_vertex_count = 0;           ///< vertices from `key_positions` on, up to the last one of the mesh
  uint32_t key_count = 0;                ///< 0 without keys, else at least 2
};

/// New `key_...` members of a deforming mesh.
struct AccelMeshKeys {
  uint32_t mesh = 0;
  const float* positions = nullptr;
  size_t stride = 0;
  size_t vertex_count = 0;
  uint32_t count = 0;
};

/// Whether the instance is part of the static geometry, which is built once.
inline bool stands_still(const AccelInstance& instance, const AccelMesh& mesh) {
  return instance.in_world_space && !mesh.deforms;
}

/// Largest element of the inverse of a transform's linear part that structures accept. It maps coordinates of 10⁹ m to
/// 10¹⁷, which Embree still accepts. Instances that are scaled to (nearly) zero exceed it and are omitted: rays have no
/// counterpart in their mesh space.
inline constexpr double kMostInverse = 1e8;

/// Position of a vertex in mesh space.
inline Vec3 vertex_position(const AccelMesh& mesh, uint32_t vertex) {
  Vec3 position;
  std::memcpy(&position, reinterpret_cast<const std::byte*>(mesh.positions) + vertex * mesh.position_stride,
              sizeof position);
  return position;
}

/// TriangleCorners of a triangle in the space of its mesh.
inline TriangleCorners corners_of(const AccelMesh& mesh, uint32_t primitive) {
  const uint32_t* index = mesh.indices + size_t{3} * primitive;
  return {vertex_position(mesh, index[0]), vertex_position(mesh, index[1]), vertex_position(mesh, index[2])};
}

/// The same at a key of the shutter; the mesh has keys.
inline TriangleCorners corners_at_key(const AccelMesh& mesh, uint32_t primitive, uint32_t key) {
  AccelMesh posed = mesh;
  posed.positions =
      reinterpret_cast<const float*>(reinterpret_cast<const std::byte*>(mesh.key_positions) + key * mesh.key_stride);
  return corners_of(posed, primitive);
}

/// The same at a time within the shutter.
inline TriangleCorners corners_at(const AccelMesh& mesh, uint32_t primitive, float time) {
  if (mesh.key_count == 0) return corners_of(mesh, primitive);
  const KeyTime at(time, mesh.key_count);
  const TriangleCorners a = corners_at_key(mesh, primitive, at.first);
  const TriangleCorners b = corners_at_key(mesh, primitive, at.first + 1);
  return {at.mix(a.p0, b.p0), at.mix(a.p1, b.p1), at.mix(a.p2, b.p2)};
}

/// Transform of an instance at a time within the shutter.
inline Mat4 to_world_at(const AccelInstance& instance, float time) {
  if (instance.key_count == 0) return instance.to_world;
  const KeyTime at(time, instance.key_count);
  return at.mix(instance.keys[at.first], instance.keys[at.first + 1]);
}

/// Owns an acceleration structure. The vertex, index and opacity arrays must outlive it.
class AccelStructure {
 public:
  AccelStructure() = default;
  virtual ~AccelStructure() = default;
  AccelStructure(const AccelStructure&) = delete;
  AccelStructure& operator=(const AccelStructure&) = delete;

  /// Sets the keys of deforming meshes within the shutter; those of all other meshes rest. Their arrays must stay until
  /// the next call. update() must follow, with these meshes and those that had keys before.
  virtual void set_keys(std::span<const AccelMeshKeys> keys) = 0;

  /// Updates transform and visibility of the instances that are not in world space, and the `deformed` meshes (indices)
  /// to their current vertices. `instances`: all, in the order of make_accel(). Throws Error if that fails.
  virtual void update(std::span<const AccelInstance> instances, std::span<const uint32_t> deformed) = 0;

  /// Sets whether hits on a mesh evaluate its opacity, and whether its back faces are culled. `instances`: as
  /// for make_accel().
  virtual void set_filters(uint32_t mesh, std::span<const AccelInstance> instances, bool needs_opacity,
                           bool culls_back_faces) = 0;

  /// Invalid after update() or set_filters(), even if they throw.
  virtual AccelView view() const = 0;

  /// Makes the structure readable by host code, which may trace rays until the next launch.
  virtual void open_for_host() const {}

  /// Bytes allocated for the structure.
  virtual size_t memory_bytes() const = 0;
};

/// Copies the keys to the meshes.
inline void assign_keys(std::span<AccelMesh> meshes, std::span<const AccelMeshKeys> keys) {
  for (AccelMesh& mesh : meshes) {
    mesh.key_positions = nullptr;
    mesh.key_count = 0;
  }
  for (const AccelMeshKeys& k : keys) {
    meshes[k.mesh].key_positions = k.positions;
    meshes[k.mesh].key_stride = k.stride;
    meshes[k.mesh].key_vertex_count = k.vertex_count;
    meshes[k.mesh].key_count = k.count;
  }
}

/// Builds the chosen structure. `opacity` may be empty if no mesh needs it. `memory`: for relume's own BVH; it must
/// outlive the structure. Throws Error if memory is short, or if the scene is too large for the structure.
std::unique_ptr<AccelStructure> make_accel(AccelChoice choice, std::span<const AccelMesh> meshes,
                                           std::span<const AccelInstance> instances, OpacityFunction opacity,
                                           Memory& memory = host_memory());

}  // namespace relume
