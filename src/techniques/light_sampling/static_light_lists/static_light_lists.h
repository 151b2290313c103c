// Light selection from precomputed lists of the lights visible from each cell, which do not follow motion. A baseline
// after Quake II RTX, with the importance of [Dittebrandt20, §7].
#pragma once

#include "sampling/choose.h"
#include "techniques/light_sampling/light_selection/infinite_lights.h"
#include "techniques/light_sampling/light_selection/light_selection.h"
#include "techniques/light_sampling/light_selection/weighed_lights.h"

namespace relume {

/// A regular grid over the scene.
struct LightGrid {
  Vec3 corner{0};
  float cell_size = 1;  ///< metres
  UVec3 cells{0};

  RELUME_HD uint32_t count() const { return cells.x * cells.y * cells.z; }
  /// Points outside belong to the nearest cell.
  RELUME_HD UVec3 coordinates(const Vec3& p) const {
    UVec3 at(0);
    for (int axis = 0; axis < 3; ++axis) {
      const float x = (p[axis] - corner[axis]) / cell_size;
      at[axis] = static_cast<uint32_t>(relume::min(relume::max(x, 0.0f), static_cast<float>(cells[axis] - 1)));
    }
    return at;
  }
  RELUME_HD uint32_t find(const Vec3& p) const {
    const UVec3 at = coordinates(p);
    return (at.z * cells.y + at.y) * cells.x + at.x;
  }
  RELUME_HD Vec3 low(uint32_t cell) const {
    const UVec3 at(cell % cells.x, cell / cells.x % cells.y, cell / (cells.x * cells.y));
    return corner + cell_size * Vec3(at);
  }
};

struct StaticLightLists {
  LightGrid grid;
  View<const uint32_t> first;  ///< first entry of each cell, then the end of the last cell
  View<const LightId> ids;     ///< sorted in each cell
  uint32_t max_lights = 32;    ///< maximum number weighed at a point
  float exploration = 0.05f;   ///< share of samples drawn from `all`
  AliasTable all;              ///< over finite lights, by power
  InfiniteLights infinite;
  LtcTable ltc;
  View<const CompactLight> compact;
  LightsView lights;

  RELUME_HD LightSelection sample(const SurfacePoint& sp, ReusableNumber n) const {
    if (infinite.takes(n)) return infinite.sample(n);
    if (all.empty()) return {};
    const List list = list_at(sp);
    if (takes_share(list.ids.empty() ? 1.0f : exploration, n)) {
      const DiscreteSample s = all.sample(n);
      return {s.index, pmf(sp, s.index), s.u};
    }
    const uint32_t offset = choose_evenly(list.stride, n);
    const WeighedLights w(candidates(list, offset), sp);
    const uint32_t i = w.choose(n);
    const LightId light = list.ids[offset + i * list.stride];
    return {light, density(list, w[i], light), n.u};
  }

  RELUME_HD float pmf(const SurfacePoint& sp, LightId light) const {
    if (light >= infinite.first) return infinite.pmf(light);
    if (all.empty()) return 0.0f;
    const List list = list_at(sp);
    if (list.ids.empty()) return (1.0f - infinite.share) * all.pmf(light);
    const uint32_t place = find(list, light);
    if (place == list.ids.size) return density(list, {}, light);
    return density(list, weigh_light(candidates(list, place % list.stride), sp, place / list.stride), light);
  }

 private:
  struct List {
    View<const LightId> ids;
    uint32_t stride = 1;
  };

  struct EveryNth {
    const LightId* first;
    uint32_t stride;

    RELUME_HD LightId operator()(uint32_t i) const { return first[i * stride]; }
  };

  RELUME_HD List list_at(const SurfacePoint& sp) const {
    if (first.size < 2) return {};
    const uint32_t cell = grid.find(sp.position);
    const uint32_t count = first[cell + 1] - first[cell];
    return {{ids.data + first[cell], count}, count == 0 ? 1 : (count + max_lights - 1) / max_lights};
  }

  /// Index of the light, or the list's length.
  RELUME_HD static uint32_t find(const List& list, LightId light) {
    uint32_t low = 0;
    uint32_t high = list.ids.size;
    while (low < high) {
      const uint32_t middle = (low + high) / 2;
      if (list.ids[middle] < light) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low < list.ids.size && list.ids[low] == light ? low : list.ids.size;
  }

  /// Every stride-th light of the list, from `offset` on.
  RELUME_HD LightCandidates<EveryNth> candidates(const List& list, uint32_t offset) const {
    const uint32_t count = (list.ids.size - offset + list.stride - 1) / list.stride;
    return {ltc, lights, compact, count, {list.ids.data + offset, list.stride}};
  }

  /// `w`: of the light among the candidates that include it; sum 0 if it is not on the list.
  RELUME_HD float density(const List& list, const WeighedLight& w, LightId light) const {
    const float listed = w.sum > 0.0f ? w.weight / (w.sum * static_cast<float>(list.stride)) : 0.0f;
    return (1.0f - infinite.share) * (exploration * all.pmf(light) + (1.0f - exploration) * listed);
  }
};

}  // namespace relume
