// Builds and updates relume's own BVH over a compiled scene.
#pragma once

#include <memory>

#include "accel/accel_structure.h"

namespace relume {

class BvhAccel final : public AccelStructure {
 public:
  BvhAccel(std::span<const AccelMesh> meshes, std::span<const AccelInstance> instances, OpacityFunction opacity,
           Memory& memory = host_memory());
  ~BvhAccel() override;

  void set_keys(std::span<const AccelMeshKeys> keys) override;
  /// Refits the trees of deformed meshes, rebuilds those with a grown RefitCost, and rebuilds the top tree. If it
  /// throws, rays hit nothing until an update succeeds.
  void update(std::span<const AccelInstance> instances, std::span<const uint32_t> deformed) override;
  void set_filters(uint32_t mesh, std::span<const AccelInstance> instances, bool needs_opacity,
                   bool culls_back_faces) override;
  AccelView view() const override;
  void open_for_host() const override;
  size_t memory_bytes() const override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace relume
