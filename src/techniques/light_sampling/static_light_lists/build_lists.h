// Finds which lights are visible from which cells.
#pragma once

#include <stop_token>
#include <vector>

#include "core/fixed_point.h"
#include "frame/launch.h"
#include "scene/scene_view.h"
#include "techniques/light_sampling/static_light_lists/static_light_lists.h"

namespace relume {

struct LightListOptions {
  float cell_size = 0;   ///< metres; 0: a 24th of the scene's longest side
  uint32_t rays = 4096;  ///< a cell; or a 64th of that a light, and two at least, if that is more

  bool operator==(const LightListOptions&) const = default;
};

/// What StaticLightLists views.
struct LightListData {
  LightGrid grid;
  std::vector<uint32_t> first;
  std::vector<LightId> ids;
};

/// Traces shadow rays from every cell that holds a surface: from points of the cell and from the surfaces that
/// are seen from them inside it, to the lights in turn. One that arrives puts the light on the list. Another `seed` has
/// other rays.
class LightListBuilder {
 public:
  /// Throws Error if this took more than 4 GiB.
  LightListBuilder(const SceneView& scene, const LightListOptions& options, uint32_t seed);

  /// Traces what is left. False if `stop` was requested first; another call continues.
  bool advance(Backend& backend, const SceneView& scene, const std::stop_token& stop);

  /// Of the rays so far.
  LightListData lists() const;

 private:
  LightGrid grid_;
  uint32_t lights_ = 0;
  uint32_t rays_ = 0;  ///< a cell
  uint32_t seed_ = 0;
  uint32_t words_ = 0;           ///< a cell
  std::vector<uint32_t> cells_;  ///< that hold a surface
  std::vector<uint64_t> visible_;
  std::vector<uint8_t> done_;  ///< by cell and part
};

/// LightListBuilder in one call.
LightListData build_light_lists(Backend& backend, const SceneView& scene, const LightListOptions& options,
                                uint32_t seed = 0);

/// Sets bit `light` of a cell's row if any ray from the cell reaches the light. `i`: the cell; `part`: of its rays,
/// small enough that a stop is answered at once.
struct CellVisibilityKernel {
  static constexpr uint32_t kPartRays = 4096;

  SceneView scene;
  LightGrid grid;
  View<const uint32_t> cells;  ///< that hold a surface
  uint32_t rays = 0;
  uint32_t seed = 0;
  uint32_t words = 0;  ///< a row
  View<uint64_t> visible;
  View<uint8_t> done;  ///< by cell and part

  RELUME_HD bool is_visible(uint32_t cell, uint32_t light) const {
    return (atomic_load(&visible[cell * words + light / 64]) >> (light % 64)) & 1u;
  }

  RELUME_HD void operator()(uint32_t i, uint32_t part) const {
    uint8_t& is_done = done[part * cells.size + i];
    if (is_done) return;
    const uint32_t end = relume::min(rays - part * kPartRays, kPartRays) + part * kPartRays;
    for (uint32_t k = part * kPartRays; k < end; ++k) trace(cells[i], k);
    is_done = 1;
  }

  /// Ray k of a cell.
  RELUME_HD void trace(uint32_t cell, uint32_t k) const {
    const uint32_t stream = hash(cell, seed);
    const uint32_t lights = scene.lights.first_infinite;
    const auto random = [&](uint32_t dimension) { return to_unit_float(hash(stream, k, dimension, 0x51a71cu)); };
    Vec3 p = grid.low(cell) + grid.cell_size * Vec3(random(0), random(1), random(2));
    // Every other point of a light is moved to a surface: places in the air see more than those that are lit.
    const uint32_t light = k % lights;
    if (k / lights % 2 == 1) {
      const Vec3 w = sphere_from_square({random(3), random(4)});
      const Hit hit = intersect(scene.accel, {p, w, 2.0f * grid.cell_size}, hash(cell, k));
      if (!hit.valid()) return;
      p += 0.999f * hit.t * w;
      if (grid.find(p) != cell) return;
    }
    if (is_visible(cell, light)) return;
    const LightSample s = sample_li(scene.lights, light, p, {random(5), random(6)});
    if (!s.valid()) return;
    const Ray ray{p, s.wi, 0.999f * s.distance};
    if (occluded(scene.accel, ray, hash(cell, k, 1u))) return;
    atomic_or(&visible[cell * words + light / 64], uint64_t{1} << (light % 64));
  }
};

}  // namespace relume
