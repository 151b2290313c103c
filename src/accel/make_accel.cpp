#include "accel/accel_structure.h"
#include "accel/bvh/bvh_accel.h"
#include "accel/embree_accel.h"

namespace relume {

std::unique_ptr<AccelStructure> make_accel(AccelChoice choice, std::span<const AccelMesh> meshes,
                                           std::span<const AccelInstance> instances, OpacityFunction opacity,
                                           Memory& memory) {
  switch (choice) {
    case AccelChoice::bvh: return std::make_unique<BvhAccel>(meshes, instances, opacity, memory);
    case AccelChoice::embree: break;
  }
  return std::make_unique<EmbreeAccel>(meshes, instances, opacity);
}

}  // namespace relume
