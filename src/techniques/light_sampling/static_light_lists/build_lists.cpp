#include "techniques/light_sampling/static_light_lists/build_lists.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "frame/primitives/scan.h"
#include "relume/error.h"
#include "scene/world_triangles.h"

namespace relume {
namespace {

constexpr size_t kMostWords = size_t{1} << 29;  // 4 GiB, within the range of 32-bit indices

LightGrid make_grid(const SceneView& scene, float cell_size) {
  const Box box = world_box(scene);
  LightGrid grid;
  if (box.empty()) return grid;
  const Vec3 extent = box.extent();
  constexpr float kDefaultCells = 24;
  constexpr float kMostCells = 128;  // along one side
  const float longest = std::max(max_component(extent), 1e-3f);
  grid.cell_size = std::max(cell_size > 0 ? cell_size : longest / kDefaultCells, longest / kMostCells);
  // A margin of 1 % of a cell, so that surfaces on the border lie inside.
  grid.corner = box.low - 0.01f * grid.cell_size;
  for (int axis = 0; axis < 3; ++axis)
    grid.cells[axis] = static_cast<uint32_t>(std::floor((extent[axis] + 0.02f * grid.cell_size) / grid.cell_size)) + 1;
  return grid;
}

/// Cells that overlap the bounding box of a triangle.
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

LightListBuilder::LightListBuilder(const SceneView& scene, const LightListOptions& options, uint32_t seed,
                                   Memory& memory)
    : grid_(make_grid(scene, options.cell_size)),
      lights_(scene.lights.first_infinite),
      seed_(seed),
      cells_(memory),
      visible_(memory),
      done_(memory) {
  if (lights_ == 0 || grid_.count() == 0) return;
  cells_.assign(cells_with_surfaces(scene, grid_));
  words_ = (lights_ + 63) / 64;
  const uint64_t for_lights = uint64_t{std::max(options.rays / 64, 2u)} * lights_;
  // The end of the last part must fit in 32 bits.
  constexpr uint64_t kMostRays = UINT32_MAX - CellVisibilityKernel::kPartRays;
  rays_ = static_cast<uint32_t>(std::clamp<uint64_t>(for_lights, options.rays, kMostRays));
  const size_t parts = (rays_ + CellVisibilityKernel::kPartRays - 1) / CellVisibilityKernel::kPartRays;
  if (size_t{words_} * grid_.count() > kMostWords || parts * cells_.size() > UINT32_MAX) {
    throw Error(
        fmt::format("static light lists of {} lights in {} cells exceed their size limit; use a larger "
                    "static-lists.cell-size, or lights 'light-tree'",
                    lights_, grid_.count()));
  }
  visible_.reset(size_t{words_} * grid_.count());
  done_.reset(cells_.size() * parts);
}

bool LightListBuilder::advance(Backend& backend, const SceneView& scene, const std::stop_token& stop) {
  if (cells_.empty()) return true;
  CellVisibilityKernel kernel;
  kernel.scene = scene;
  kernel.grid = grid_;
  kernel.cells = cells_.view();
  kernel.rays = rays_;
  kernel.seed = seed_;
  kernel.words = words_;
  kernel.visible = visible_.mutable_view();
  kernel.done = done_.mutable_view();
  return launch(backend, "static-lists.rays", kernel, kernel.cells.size, kernel.done.size / kernel.cells.size, stop, 1);
}

void LightListBuilder::write_lists(Backend& backend, Array<uint32_t>& first, Array<LightId>& ids) {
  first.clear();
  ids.clear();
  if (words_ == 0) return;
  const uint32_t cells = grid_.count();
  first.reset(size_t{cells} + 1, kUninitialized);
  const VisibleLightCounts counts{visible_.view(), words_, cells};
  ids.reset(exclusive_scan({backend, "static-lists.lists", scratch_}, counts, first.mutable_view()), kUninitialized);
  const WriteListKernel kernel{visible_.view(), words_, first.view(), ids.mutable_view()};
  launch(backend, "static-lists.lists", kernel, cells, 1);
}

LightListData LightListBuilder::lists(Backend& backend) {
  Array<uint32_t> first(backend.memory());
  Array<LightId> ids(backend.memory());
  write_lists(backend, first, ids);
  return {grid_, {first.read().begin(), first.read().end()}, {ids.read().begin(), ids.read().end()}};
}

LightListData build_light_lists(Backend& backend, const SceneView& scene, const LightListOptions& options,
                                uint32_t seed) {
  LightListBuilder builder(scene, options, seed);
  builder.advance(backend, scene, {});
  return builder.lists(backend);
}

}  // namespace relume
