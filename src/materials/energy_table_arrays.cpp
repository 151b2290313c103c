#include "materials/energy_table_arrays.h"

#include <span>
#include <utility>

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

void EnergyTableArrays::update(const LayerTables& needed) {
  const EnergyTables& source = layered_energy_tables(needed);
  if (copied_ == &source) return;
  EnergyTables tables = source;
  size_t count = 0;
  for_each_share_table(tables, [&](const View<const Vec2>& table) { count += table.size; });
  Array<Vec2> shares(shares_.memory());
  shares.reserve(count);
  for_each_share_table(tables, [&](const View<const Vec2>& table) { shares.append(elements_of(table)); });
  uint32_t first = 0;
  for_each_share_table(tables, [&](View<const Vec2>& table) {
    table.data = shares.view().data + first;
    first += table.size;
  });
  Array<float> sheen(sheen_.memory());
  sheen.assign(elements_of(source.sheen.albedo));
  tables.sheen.albedo = sheen.view();
  shares_ = std::move(shares);
  sheen_ = std::move(sheen);
  view_ = tables;
  copied_ = &source;
}

void EnergyTableArrays::open_for_host() const {
  shares_.permit_reading();
  sheen_.permit_reading();
}

}  // namespace relume
