// Builds Embree's acceleration structure over a compiled scene.
#pragma once

#include <cstddef>
#include <cstring>
#include <memory>
#include <span>
#include <string>

#include "accel/accel.h"
#include "core/vec.h"
#include "core/view.h"

namespace relume {

/// Decides how much of a triangle is there, for alpha masks and blending: value in [0, 1].
struct OpacityFunction {
  float (*function)(const void* context, uint32_t instance, uint32_t primitive, float u, float v) = nullptr;
  const void* context = nullptr;
};

/// One instance of a triangle mesh.
struct AccelInstance {
  uint32_t mesh = 0;
  Mat4 to_world{1};
  bool in_world_space = true;  ///< vertices are stored transformed: no instance node is made, unless the mesh deforms
  bool moves = false;          ///< update() may place it elsewhere, or hide it
  bool visible = true;         ///< false: rays pass
  bool mirrored = false;       ///< in world space: its skin turns the back of its triangles to the front
};

struct AccelMesh {
  const float* positions = nullptr;   ///< first of all vertices
  size_t position_stride = 0;         ///< bytes
  size_t vertex_count = 0;            ///< of the whole array
  const uint32_t* indices = nullptr;  ///< three a triangle, into the whole array
  size_t triangle_count = 0;
  bool needs_opacity = false;
  bool culls_back_faces = false;  ///< for the camera
  bool deforms = false;           ///< update() may find its vertices moved
  bool mirrored = false;          ///< follows AccelInstance::mirrored
};

/// Vertex of that number, in the space of its mesh.
inline Vec3 vertex_position(const AccelMesh& mesh, uint32_t vertex) {
  Vec3 position;
  std::memcpy(&position, reinterpret_cast<const std::byte*>(mesh.positions) + vertex * mesh.position_stride,
              sizeof position);
  return position;
}

/// Owns the structure. The vertex, index and opacity arrays must outlive it.
class EmbreeAccel {
 public:
  EmbreeAccel(std::span<const AccelMesh> meshes, std::span<const AccelInstance> instances, OpacityFunction opacity);
  ~EmbreeAccel();
  EmbreeAccel(const EmbreeAccel&) = delete;
  EmbreeAccel& operator=(const EmbreeAccel&) = delete;

  /// Moves the instances that are not in world space, and refits the `deformed` meshes to their vertices. Takes longer
  /// the more of these there are; what stands in world space costs nothing if some instance was said to move.
  void update(std::span<const AccelInstance> instances, std::span<const uint32_t> deformed = {});

  /// Whether hits on a mesh ask for its opacity, and whether its back faces are culled, from now on. `instances` as
  /// constructed.
  void set_filters(uint32_t mesh, std::span<const AccelInstance> instances, bool needs_opacity, bool culls_back_faces);

  AccelView view() const;

  /// Bytes that Embree holds.
  size_t memory_bytes() const;

  /// Version of the library that runs, "3.13.5". Throws Error if it cannot be started.
  static std::string embree_version();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace relume
