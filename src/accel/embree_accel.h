// Builds Embree's acceleration structure over a compiled scene.
#pragma once

#include <memory>
#include <string>

#include "accel/accel_structure.h"

namespace relume {

class EmbreeAccel final : public AccelStructure {
 public:
  /// `robust`: Embree's robust mode, for comparisons. A ray at an edge then hits one of both triangles, but a frame
  /// takes 12 % longer on the Cornell box and 23 % on Sponza, and no mean changes.
  EmbreeAccel(std::span<const AccelMesh> meshes, std::span<const AccelInstance> instances, OpacityFunction opacity,
              bool robust = false);
  ~EmbreeAccel() override;

  void set_keys(std::span<const AccelMeshKeys> keys) override;
  /// Static geometry costs nothing if any instance was declared as moving, because it then has a BVH of its own.
  void update(std::span<const AccelInstance> instances, std::span<const uint32_t> deformed) override;
  void set_filters(uint32_t mesh, std::span<const AccelInstance> instances, bool needs_opacity,
                   bool culls_back_faces) override;
  AccelView view() const override;
  size_t memory_bytes() const override;

  /// Version of the loaded library, such as "3.13.5". Throws Error if it cannot be started.
  static std::string embree_version();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace relume
