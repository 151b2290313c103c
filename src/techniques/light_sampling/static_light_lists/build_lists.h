// Finds the lights visible from each cell by random shadow rays.
#pragma once

#include <bit>
#include <stop_token>
#include <vector>

#include "core/array.h"
#include "core/fixed_point.h"
#include "frame/launch.h"
#include "frame/primitives/primitive.h"
#include "scene/ray_queries.h"
#include "techniques/light_sampling/static_light_lists/static_light_lists.h"

namespace relume {

struct LightListOptions {
  float cell_size = 0;     ///< metres; 0: 1/24 of the scene's longest side
  uint32_t rays = 4096;    ///< per cell; more if needed for max(rays / 64, 2) per light
  bool from_sets = false;  ///< lists of lists_from_visible_sets(); rays have no effect

  bool operator==(const LightListOptions&) const = default;
};

/// The lists of StaticLightLists on the host.
struct LightListData {
  LightGrid grid;
  std::vector<uint32_t> first;
  std::vector<LightId> ids;
};

/// Traces shadow rays to the lights in turn, from every cell with a surface. Half start at random points, half at
/// surfaces seen from there within the cell. Unblocked rays put their light on the list.
class LightListBuilder {
 public:
  /// `seed` selects the rays. Throws Error if a table of the build would exceed 4 GiB. Reads the scene on the host.
  LightListBuilder(const SceneView& scene, const LightListOptions& options, uint32_t seed,
                   Memory& memory = host_memory());

  /// Traces the remaining rays. Returns false if `stop` was requested first; another call continues.
  bool advance(Backend& backend, const SceneView& scene, const std::stop_token& stop);

  const LightGrid& grid() const { return grid_; }
  /// Writes the lists from the rays traced so far. `first`: offset of each cell's list in `ids`, then the total.
  void write_lists(Backend& backend, Array<uint32_t>& first, Array<LightId>& ids);
  /// The same for host code.
  LightListData lists(Backend& backend);

 private:
  LightGrid grid_;
  uint32_t lights_ = 0;
  uint32_t rays_ = 0;  ///< per cell
  uint32_t seed_ = 0;
  uint32_t words_ = 0;     ///< 64-bit words per cell
  Array<uint32_t> cells_;  ///< with a surface
  Array<uint64_t> visible_;
  Array<uint8_t> done_;  ///< by cell and part
  PrimitiveScratch scratch_;
};

LightListData build_light_lists(Backend& backend, const SceneView& scene, const LightListOptions& options,
                                uint32_t seed = 0);

/// Number of lights that a cell sees; 0 for the element after the last cell.
struct VisibleLightCounts {
  View<const uint64_t> visible;
  uint32_t words = 0;  ///< 64-bit words per cell
  uint32_t cells = 0;

  RELUME_HD uint32_t operator()(size_t cell) const {
    uint32_t count = 0;
    for (uint32_t word = 0; cell < cells && word < words; ++word)
      count += static_cast<uint32_t>(std::popcount(visible.data[cell * words + word]));
    return count;
  }
};

/// Writes the lights that a cell sees, in ascending order; one call per cell.
struct WriteListKernel {
  View<const uint64_t> visible;
  uint32_t words = 0;
  View<const uint32_t> first;
  View<LightId> ids;

  RELUME_HD void operator()(uint32_t cell, uint32_t) const {
    uint32_t next = first[cell];
    for (uint32_t word = 0; word < words; ++word) {
      for (uint64_t bits = visible.data[size_t{cell} * words + word]; bits != 0; bits &= bits - 1)
        ids[next++] = 64 * word + static_cast<uint32_t>(std::countr_zero(bits));
    }
  }
};

/// Sets bit `light` of a cell's row if any ray reaches the light. `i`: index into `cells`; `part`: a batch of rays,
/// small enough for quick stops.
struct CellVisibilityKernel {
  static constexpr uint32_t kPartRays = 4096;

  SceneView scene;
  LightGrid grid;
  View<const uint32_t> cells;  ///< with a surface
  uint32_t rays = 0;
  uint32_t seed = 0;
  uint32_t words = 0;  ///< 64-bit words per row
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

  RELUME_HD void trace(uint32_t cell, uint32_t k) const {
    const uint32_t stream = hash(cell, seed);
    const uint32_t lights = scene.lights.first_infinite;
    const auto random = [&](uint32_t dimension) { return to_unit_float(hash(stream, k, dimension, 0x51a71cu)); };
    Vec3 p = grid.low(cell) + grid.cell_size * Vec3(random(0), random(1), random(2));
    // Every second ray to a light starts at a surface: points in the air see more lights than surfaces.
    const uint32_t light = k % lights;
    if (k / lights % 2 == 1) {
      const Vec3 w = sphere_from_square({random(3), random(4)});
      const Hit hit = intersect(scene, {p, w, 2.0f * grid.cell_size}, hash(cell, k));
      if (!hit.valid()) return;
      p += 0.999f * hit.t * w;
      if (grid.find(p) != cell) return;
    }
    if (is_visible(cell, light)) return;
    const LightSample s = sample_li(scene.lights, light, p, {random(5), random(6)});
    if (!s.valid()) return;
    const Ray ray{p, s.wi, 0.999f * s.distance};
    if (occluded(scene, ray, hash(cell, k, 1u))) return;
    atomic_or(&visible[cell * words + light / 64], uint64_t{1} << (light % 64));
  }
};

}  // namespace relume
