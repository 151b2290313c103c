#include "techniques/light_sampling/static_light_lists/visible_set_lists.h"

#include <algorithm>
#include <cmath>

#include "core/box.h"

namespace relume {
namespace {

constexpr int kMostCells = 128;      // along the longest side
constexpr float kTolerance = 1e-3f;  // of a cell

/// Whether all edges of the boxes are whole numbers of cells from the corner, along x and z. Rooms have one height.
bool is_aligned(const std::vector<VisibleSet>& sets, const Vec3& corner, float cell_size) {
  for (const VisibleSet& set : sets) {
    for (const Vec3& p : {set.low, set.high}) {
      for (const int axis : {0, 2}) {
        const float cells = (p[axis] - corner[axis]) / cell_size;
        if (std::fabs(cells - std::round(cells)) > kTolerance) return false;
      }
    }
  }
  return true;
}

float choose_cell_size(const std::vector<VisibleSet>& sets, const Box& whole) {
  const float longest = max_component(whole.extent());
  for (int n = 1; n <= kMostCells; ++n) {
    const float size = longest / static_cast<float>(n);
    if (is_aligned(sets, whole.low, size)) return size;
  }
  return longest / 24;
}

LightGrid make_grid(const std::vector<VisibleSet>& sets, float cell_size) {
  Box whole;
  for (const VisibleSet& set : sets) whole.add(Box{set.low, set.high});
  const float least = max_component(whole.extent()) / kMostCells;
  LightGrid grid;
  grid.corner = whole.low;
  grid.cell_size = cell_size > 0 ? std::max(cell_size, least) : choose_cell_size(sets, whole);
  for (int axis = 0; axis < 3; ++axis) {
    const float cells = std::ceil(whole.extent()[axis] / grid.cell_size - kTolerance);
    grid.cells[axis] = std::max(static_cast<uint32_t>(cells), 1u);
  }
  return grid;
}

/// Whether the boxes have a common point; with a negative margin, more than a face.
bool overlap(const Box& a, const Box& b, float margin) {
  return max_component(glm::max(a.low, b.low) - glm::min(a.high, b.high)) <= margin;
}

}  // namespace

LightListData lists_from_visible_sets(const LightsView& lights, const std::vector<VisibleSet>& sets, float cell_size) {
  LightListData data;
  data.grid = make_grid(sets, cell_size);
  const float margin = kTolerance * data.grid.cell_size;
  std::vector<std::vector<LightId>> lights_in(sets.size());
  std::vector<LightId> everywhere;
  for (LightId id = 0; id < lights.first_infinite; ++id) {
    const Box box = extent_of(lights.lights[id], 1).box;
    bool is_inside = false;
    for (size_t i = 0; i < sets.size(); ++i) {
      if (!overlap(box, Box{sets[i].low, sets[i].high}, margin)) continue;
      lights_in[i].push_back(id);
      is_inside = true;
    }
    if (!is_inside) everywhere.push_back(id);
  }
  data.first.push_back(0);
  for (uint32_t cell = 0; cell < data.grid.count(); ++cell) {
    const Vec3 low = data.grid.low(cell);
    std::vector<LightId> list = everywhere;
    for (const VisibleSet& set : sets) {
      if (!overlap(Box{low, low + data.grid.cell_size}, Box{set.low, set.high}, -margin)) continue;
      for (const uint32_t seen : set.visible) list.insert(list.end(), lights_in[seen].begin(), lights_in[seen].end());
    }
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    data.ids.insert(data.ids.end(), list.begin(), list.end());
    data.first.push_back(static_cast<uint32_t>(data.ids.size()));
  }
  return data;
}

}  // namespace relume
