// Light selection from lists of screen tiles, which hold the lights that were useful to their pixels in the last
// frames, and from all lights by power and use ([Rtxpt26], "NEE-AT"). Both are counts of proxies: equally likely
// entries, of which a light may have several.
#pragma once

#include "sampling/choose.h"
#include "scene/camera_view.h"
#include "scene/surface_point.h"
#include "techniques/light_sampling/light_selection/light_selection.h"

namespace relume {

inline constexpr uint32_t kNoTile = 0xffffffffu;

/// Distance of a point from a camera, metres; from the sensor's plane for orthographic cameras.
RELUME_HD inline float distance_from(const CameraView& c, const Vec3& p) {
  return c.projection == Projection::orthographic ? -glm::dot(p - c.position, c.axes.n) : glm::length(p - c.position);
}

/// Finds the raster position at which the camera sees a point, at any distance > 0. Returns false outside the image.
RELUME_HD inline bool raster_of(const CameraView& c, const Vec3& p, Vec2* raster, float* distance) {
  *distance = distance_from(c, p);
  if (!(*distance > 0.0f) || !is_finite(*distance)) return false;
  Ray ray{p, -c.axes.n, kInfinity};
  if (c.projection != Projection::orthographic) ray = {c.position, (p - c.position) / *distance, kInfinity};
  return raster_position(c, ray, raster);
}

/// Square tiles over the image of a camera, shifted by `offset` < tile_size pixels.
struct TileGrid {
  CameraView camera = {};  ///< of the frame whose paths filled the lists
  uint32_t tile_size = 1;
  uint32_t list_size = 0;  ///< entries per list
  uint32_t columns = 0;
  uint32_t rows = 0;
  UVec2 offset{0};

  RELUME_HD uint32_t count() const { return columns * rows; }
  /// Tile of a pixel inside the image.
  RELUME_HD uint32_t tile_of(uint32_t x, uint32_t y) const {
    return (y + offset.y) / tile_size * columns + (x + offset.x) / tile_size;
  }
};

/// Distances between which the first surfaces of a tile lie, metres. The default holds no point.
struct TileDepths {
  float nearest = kInfinity;
  float farthest = 0;

  RELUME_HD void add(float distance) {
    nearest = relume::min(nearest, distance);
    farthest = relume::max(farthest, distance);
  }
  RELUME_HD bool empty() const { return !(nearest <= farthest); }
  /// Whether the distance is within them, up to the factor `tolerance` ≥ 1.
  RELUME_HD bool holds(float distance, float tolerance) const {
    return distance * tolerance >= nearest && distance <= farthest * tolerance;
  }
};

/// Entries [first, first + count) of a list, which all are one light.
struct ProxyRun {
  uint32_t first = 0;
  uint32_t count = 0;
};

/// The lists of all tiles.
struct TileLists {
  TileGrid grid;
  float depth_tolerance = 1;
  View<const LightId> lights;  ///< grid.list_size per tile, sorted
  View<const TileDepths> depths;

  /// The tile where the camera sees a surface point; kNoTile outside the image, and in front of or behind the surfaces
  /// of the tile. `p`: the position in the camera's frame.
  RELUME_HD uint32_t find(const Vec3& p) const {
    if (grid.count() == 0) return kNoTile;
    Vec2 raster;
    float distance;
    if (!raster_of(grid.camera, p, &raster, &distance)) return kNoTile;
    const uint32_t tile = grid.tile_of(static_cast<uint32_t>(raster.x), static_cast<uint32_t>(raster.y));
    return depths[tile].holds(distance, depth_tolerance) ? tile : kNoTile;
  }
  RELUME_HD LightId light(uint32_t tile, uint32_t entry) const { return lights[tile * grid.list_size + entry]; }

  /// The entries of a light, by binary search.
  RELUME_HD ProxyRun run_of(uint32_t tile, LightId light) const {
    const uint32_t first = lower_bound(tile, light);
    return {first, lower_bound(tile, light + 1) - first};
  }

 private:
  /// First entry that is not below `light`.
  RELUME_HD uint32_t lower_bound(uint32_t tile, LightId light) const {
    const LightId* const list = lights.data + size_t{tile} * grid.list_size;
    uint32_t low = 0;
    uint32_t high = grid.list_size;
    while (low < high) {
      const uint32_t middle = (low + high) / 2;
      if (list[middle] < light) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low;
  }
};

/// Proxies of all lights, in the order of ids.
struct LightProxies {
  View<const uint32_t> first;  ///< number of the first proxy by light, then the total; empty: no lights

  RELUME_HD uint32_t light_count() const { return first.empty() ? 0 : first.size - 1; }
  RELUME_HD uint32_t total() const { return first.empty() ? 0 : first[first.size - 1]; }
  RELUME_HD ProxyRun run_of(LightId light) const { return {first[light], first[light + 1] - first[light]}; }
  /// The light that owns a proxy below the total.
  RELUME_HD LightId owner(uint32_t proxy) const {
    uint32_t low = 0;
    uint32_t high = light_count() - 1;
    while (low < high) {
      const uint32_t middle = (low + high + 1) / 2;
      if (first[middle] <= proxy) {
        low = middle;
      } else {
        high = middle - 1;
      }
    }
    return low;
  }
};

struct AdaptiveTiles {
  TileLists tiles;
  LightProxies all;
  float local = 0.65f;  ///< share of samples from the tile's list, where there is one

  /// `u`, `bits`: those of a ReusableNumber, as numbers because a copy of it enlarges the stack of all paths.
  RELUME_HD LightSelection sample(const SurfacePoint& sp, float u, uint32_t bits) const {
    ReusableNumber n{u, bits};
    if (all.total() == 0) return {};
    const uint32_t tile = tiles.find(sp.previous_position);
    if (tile == kNoTile || !takes_share(local, n)) {
      const uint32_t proxy = choose_evenly(all.total(), n);
      const LightId light = all.owner(proxy);
      return {light, density(tile, light), rest_within(all.run_of(light), proxy, n.u)};
    }
    const uint32_t entry = choose_evenly(tiles.grid.list_size, n);
    const LightId light = tiles.light(tile, entry);
    if (light >= all.light_count()) return {};  // it has vanished
    return {light, density(tile, light), rest_within(tiles.run_of(tile, light), entry, n.u)};
  }

  RELUME_HD float pmf(const SurfacePoint& sp, LightId light) const {
    return light < all.light_count() && all.total() > 0 ? density(tiles.find(sp.previous_position), light) : 0.0f;
  }

 private:
  /// Uniform in [0, 1) over the run of a light, from the chosen proxy and the rest of the number.
  RELUME_HD static float rest_within(const ProxyRun& run, uint32_t proxy, float u) {
    const float place = static_cast<float>(static_cast<int>(proxy - run.first)) + u;
    return relume::min(place / static_cast<float>(static_cast<int>(run.count)), kOneMinusEpsilon);
  }

  RELUME_HD static float share(uint32_t count, uint32_t total) {
    return static_cast<float>(static_cast<int>(count)) / static_cast<float>(static_cast<int>(total));
  }

  /// Probability of a light: a one-sample mixture.
  RELUME_HD float density(uint32_t tile, LightId light) const {
    const float any = share(all.run_of(light).count, all.total());
    if (tile == kNoTile) return any;
    return local * share(tiles.run_of(tile, light).count, tiles.grid.list_size) + (1.0f - local) * any;
  }
};

}  // namespace relume
