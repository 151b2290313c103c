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
};

struct AccelMesh {
  const float* positions = nullptr;   ///< first of all vertices
  size_t position_stride = 0;         ///< bytes
  size_t vertex_count = 0;            ///< vertices of the whole array
  const uint32_t* indices = nullptr;  ///< three per triangle, into the whole array
  size_t triangle_count = 0;
  bool needs_opacity = false;
  bool culls_back_faces = false;  ///< for camera rays
  bool deforms = false;           ///< whether update() may change its vertices
  bool mirrored = false;          ///< follows AccelInstance::mirrored
};

/// Position of a vertex in mesh space.
inline Vec3 vertex_position(const AccelMesh& mesh, uint32_t vertex) {
  Vec3 position;
  std::memcpy(&position, reinterpret_cast<const std::byte*>(mesh.positions) + vertex * mesh.position_stride,
              sizeof position);
  return position;
}

/// Owns the acceleration structure. The vertex, index and opacity arrays must outlive it.
class EmbreeAccel {
 public:
  EmbreeAccel(std::span<const AccelMesh> meshes, std::span<const AccelInstance> instances, OpacityFunction opacity);
  ~EmbreeAccel();
  EmbreeAccel(const EmbreeAccel&) = delete;
  EmbreeAccel& operator=(const EmbreeAccel&) = delete;

  /// Updates the transforms of instances that are not in world space, and refits the `deformed` meshes. The cost grows
  /// with their number. Static geometry costs nothing if any instance was declared as moving, because it then has a BVH
  /// of its own.
  void update(std::span<const AccelInstance> instances, std::span<const uint32_t> deformed = {});

  /// Sets whether hits on a mesh evaluate its opacity, and whether its back faces are culled. `instances` as in the
  /// constructor.
  void set_filters(uint32_t mesh, std::span<const AccelInstance> instances, bool needs_opacity, bool culls_back_faces);

  AccelView view() const;

  /// Bytes allocated by Embree.
  size_t memory_bytes() const;

  /// Version of the loaded library, such as "3.13.5". Throws Error if it cannot be started.
  static std::string embree_version();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace relume
