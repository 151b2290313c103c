// Finds which lights are visible from which cells.
#pragma once

#include <vector>

#include "backend/launch.h"
#include "scene/scene_view.h"
#include "techniques/static_light_lists/static_light_lists.h"

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
/// other rays. Throws Error if this took more than 4 GiB.
LightListData build_light_lists(Backend& backend, const SceneView& scene, const LightListOptions& options,
                                uint32_t seed = 0);

/// Sets bit `light` of a cell's row if any ray from the cell reaches the light.
struct CellVisibilityKernel {
  SceneView scene;
  LightGrid grid;
  View<const uint32_t> cells;  ///< that hold a surface
  uint32_t rays = 0;
  uint32_t seed = 0;
  uint32_t words = 0;  ///< a row
  View<uint32_t> visible;

  RELUME_HD void operator()(uint32_t i, uint32_t) const {
    const uint32_t cell = cells[i];
    const uint32_t stream = hash(cell, seed);
    const Vec3 low = grid.low(cell);
    const uint32_t lights = scene.lights.first_infinite;
    for (uint32_t k = 0; k < rays; ++k) {
      const auto random = [&](uint32_t dimension) { return to_unit_float(hash(stream, k, dimension, 0x51a71cu)); };
      Vec3 p = low + grid.cell_size * Vec3(random(0), random(1), random(2));
      // Every other point of a light is moved to a surface: places in the air see more than those that are lit.
      const uint32_t light = k % lights;
      if (k / lights % 2 == 1) {
        const Vec3 w = sphere_from_square({random(3), random(4)});
        const Hit hit = intersect(scene.accel, {p, w, 2.0f * grid.cell_size}, hash(cell, k));
        if (!hit.valid()) continue;
        p += 0.999f * hit.t * w;
        if (grid.find(p) != cell) continue;
      }
      if ((visible[cell * words + light / 32] >> (light % 32)) & 1u) continue;
      const LightSample s = sample_li(scene.lights, light, p, {random(5), random(6)});
      if (!s.valid()) continue;
      const Ray ray{p, s.wi, 0.999f * s.distance};
      if (!occluded(scene.accel, ray, hash(cell, k, 1u))) visible[cell * words + light / 32] |= 1u << (light % 32);
    }
  }
};

}  // namespace relume
