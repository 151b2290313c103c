#include "materials/energy_table_arrays.h"

#include <span>

namespace relume {
namespace {

/// Calls f(table) for every table of (total, grazing).
template <typename F>
void for_each_share_table(EnergyTables& tables, const F& f) {
  for (EnergyTable* model : {&tables.ggx, &tables.beckmann}) {
    f(model->directional);
    f(model->average);
  }
  f(tables.anisotropic.directional);
  f(tables.anisotropic.average);
}

template <typename T>
std::span<const T> elements_of(const View<const T>& table) {
  return {table.data, table.size};
}

}  // namespace

void EnergyTableArrays::hold(const LayerTables& needed) {
  const EnergyTables& source = layered_energy_tables(needed);
  if (copied_ == &source) return;
  copied_ = &source;
  view_ = source;
  shares_.clear();
  for_each_share_table(view_, [&](const View<const Vec2>& table) { shares_.append(elements_of(table)); });
  uint32_t first = 0;
  for_each_share_table(view_, [&](View<const Vec2>& table) {
    table.data = shares_.view().data + first;
    first += table.size;
  });
  sheen_.assign(elements_of(source.sheen.albedo));
  view_.sheen.albedo = sheen_.view();
}

void EnergyTableArrays::open_for_host() const {
  shares_.read();
  sheen_.read();
}

}  // namespace relume
