// Copies of the energy tables in the memory that kernels access.
#pragma once

#include "core/array.h"
#include "materials/energy_tables.h"

namespace relume {

/// Owns the copies. Keeps them until other tables are needed.
class EnergyTableArrays {
 public:
  explicit EnergyTableArrays(Memory& memory = host_memory()) : shares_(memory), sheen_(memory) {}
  EnergyTableArrays(const EnergyTableArrays&) = delete;
  EnergyTableArrays& operator=(const EnergyTableArrays&) = delete;

  /// Copies layered_energy_tables(needed), unless the arrays already contain it. Changes nothing if it throws.
  void update(const LayerTables& needed);

  /// The copies; valid until update() changes them.
  EnergyTables view() const { return view_; }
  /// Makes the arrays of view() readable by the host until the next launch.
  void open_for_host() const;
  size_t memory_bytes() const { return shares_.memory_bytes() + sheen_.memory_bytes(); }

 private:
  const EnergyTables* copied_ = nullptr;  ///< source of the content
  Array<Vec2> shares_;                    ///< all tables of (total, grazing), one after the other
  Array<float> sheen_;
  EnergyTables view_;
};

}  // namespace relume
