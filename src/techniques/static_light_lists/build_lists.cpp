#include "techniques/static_light_lists/build_lists.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/error.h"
#include "scene/world_triangles.h"

namespace relume {
namespace {

constexpr size_t kMostWords = size_t{1} << 30;  // 4 GiB, and what an index of 32 bits reaches

LightGrid make_grid(const SceneView& scene, float cell_size) {
  const Box box = world_box(scene);
  LightGrid grid;
  if (box.empty()) return grid;
  const Vec3 extent = box.extent();
  constexpr float kDefaultCells = 24;
  constexpr float kMostCells = 128;  // along one side
  const float longest = std::max(max_component(extent), 1e-3f);
  grid.cell_size = std::max(cell_size > 0 ? cell_size : longest / kDefaultCells, longest / kMostCells);
  // A little of air around, so that surfaces on the border lie inside.
  grid.corner = box.low - 0.01f * grid.cell_size;
  for (int axis = 0; axis < 3; ++axis)
    grid.cells[axis] = static_cast<uint32_t>(std::floor((extent[axis] + 0.02f * grid.cell_size) / grid.cell_size)) + 1;
  return grid;
}

/// Cells that the box of a triangle touches.
std::vector<uint32_t> cells_with_surfaces(const SceneView& scene, const LightGrid& grid) {
  std::vector<bool> touched(grid.count(), false);
  for_each_world_triangle(scene, [&](const Vec3& a, const Vec3& b, const Vec3& c) {
    const UVec3 low = grid.coordinates(glm::min(a, glm::min(b, c)));
    const UVec3 high = grid.coordinates(glm::max(a, glm::max(b, c)));
    for (uint32_t z = low.z; z <= high.z; ++z) {
      for (uint32_t y = low.y; y <= high.y; ++y) {
        for (uint32_t x = low.x; x <= high.x; ++x) touched[(z * grid.cells.y + y) * grid.cells.x + x] = true;
      }
    }
  });
  std::vector<uint32_t> cells;
  for (uint32_t i = 0; i < grid.count(); ++i) {
    if (touched[i]) cells.push_back(i);
  }
  return cells;
}

}  // namespace

LightListData build_light_lists(Backend& backend, const SceneView& scene, const LightListOptions& options,
                                uint32_t seed) {
  LightListData data;
  const uint32_t lights = scene.lights.first_infinite;
  data.grid = make_grid(scene, options.cell_size);
  if (lights == 0 || data.grid.count() == 0) return data;
  const std::vector<uint32_t> cells = cells_with_surfaces(scene, data.grid);
  const uint32_t words = (lights + 31) / 32;
  if (size_t{words} * data.grid.count() > kMostWords) {
    throw Error(fmt::format(
        "static light lists of {} lights in {} cells would not fit; use a larger static-lists.cell-size, or "
        "lights 'light-tree'",
        lights, data.grid.count()));
  }
  std::vector<uint32_t> visible(size_t{words} * data.grid.count(), 0);
  CellVisibilityKernel kernel;
  kernel.scene = scene;
  kernel.grid = data.grid;
  kernel.cells = view_of(cells);
  const uint64_t for_lights = uint64_t{std::max(options.rays / 64, 2u)} * lights;
  kernel.rays = static_cast<uint32_t>(std::clamp<uint64_t>(for_lights, options.rays, UINT32_MAX));
  kernel.seed = seed;
  kernel.words = words;
  kernel.visible = mutable_view_of(visible);
  launch(backend, "static-lists.rays", kernel, static_cast<uint32_t>(cells.size()), 1);
  for (uint32_t cell = 0; cell < data.grid.count(); ++cell) {
    data.first.push_back(static_cast<uint32_t>(data.ids.size()));
    for (LightId light = 0; light < lights; ++light) {
      if ((visible[size_t{cell} * words + light / 32] >> (light % 32)) & 1u) data.ids.push_back(light);
    }
  }
  data.first.push_back(static_cast<uint32_t>(data.ids.size()));
  return data;
}

}  // namespace relume
