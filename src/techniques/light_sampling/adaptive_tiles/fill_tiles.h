// Kernels that keep the lights of pixels over frames, count the use of lights, and fill the lists of tiles.
#pragma once

#include "core/fixed_point.h"
#include "sampling/alias_table.h"
#include "techniques/light_sampling/adaptive_tiles/adaptive_tiles.h"
#include "techniques/light_sampling/light_selection/light_feedback.h"

namespace relume {

/// Adds the feedback of the frame before to that of the last frame, which it replaces. A pixel keeps a light in
/// proportion to the sum of its contributions over frames, of which each frame counts `decay` as much as the next. A
/// contribution is divided by the probability of its sample, so the choice does not depend on how often paths try a
/// light; and a pixel keeps its light in frames that find none. Without this, the light of most pixels would displace
/// all others from a list.
struct KeepLightsKernel {
  static constexpr float kLeast = 1e-30f;  ///< weight, above denormal numbers

  View<LightFeedback> feedback;      ///< by pixel
  View<const LightFeedback> before;  ///< of the frame before, complete: with what it kept
  CameraView camera = {};            ///< of the last frame
  CameraView camera_before = {};     ///< both with the size of the image as resolution
  View<const AliasEntry> power;      ///< by light
  float depth_tolerance = 1;
  float decay = 0;
  uint32_t seed = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * static_cast<uint32_t>(camera.resolution.x) + x;
    LightFeedback& f = feedback[pixel];
    const LightFeedback* const old = f.has_surface() ? earlier(f) : unchanged(pixel);
    if (old == nullptr) return;
    const LightId id = old->id();
    const bool is_sampled = id < power.size && power[id].pmf > 0.0f;
    if (!f.has_surface()) f.position = f.previous_position = old->position;
    if (!is_sampled || !(old->weight > 0.0f)) return;
    f.offer(id, !old->is_direct(), relume::max(old->weight * decay, kLeast), to_unit_float(hash(seed, pixel)));
  }

 private:
  RELUME_HD static uint32_t pixel_at(const CameraView& c, const Vec2& raster) {
    return static_cast<uint32_t>(raster.y) * static_cast<uint32_t>(c.resolution.x) + static_cast<uint32_t>(raster.x);
  }

  /// Feedback of the pixel that saw the surface in the frame before; nullptr if it saw another, by distance.
  RELUME_HD const LightFeedback* earlier(const LightFeedback& f) const {
    Vec2 raster;
    float distance;
    if (!raster_of(camera_before, f.previous_position, &raster, &distance)) return nullptr;
    const LightFeedback& old = before[pixel_at(camera_before, raster)];
    if (!old.has_surface()) return nullptr;
    TileDepths depths;
    depths.add(distance_from(camera_before, old.position));
    return depths.holds(distance, depth_tolerance) ? &old : nullptr;
  }

  /// For a pixel without a surface: perhaps it had no path in the last frame. Its feedback of the frame before, if the
  /// camera still sees that surface there.
  RELUME_HD const LightFeedback* unchanged(uint32_t pixel) const {
    const LightFeedback& old = before[pixel];
    Vec2 raster;
    float distance;
    if (!old.has_surface() || !raster_of(camera, old.position, &raster, &distance)) return nullptr;
    return pixel_at(camera, raster) == pixel ? &old : nullptr;
  }
};

/// Counts the pixels whose feedback holds each light.
struct CountUsedLightsKernel {
  View<const LightFeedback> feedback;
  View<const AliasEntry> power;  ///< by light
  uint32_t width = 0;
  View<uint32_t> counts;  ///< by light

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const LightId id = feedback[y * width + x].id();
    if (id < power.size && power[id].pmf > 0.0f) atomic_add(&counts[id], 1u);
  }
};

/// Number of proxies by light: its share of the power, blended with its share of the use. 0 for lights that light
/// selection leaves out, and for the element after the last light. The input of a prefix sum.
struct ProxyCounts {
  static constexpr float kBudget = 0x1p24f;  ///< of all lights, with at most one more for each

  View<const AliasEntry> power;
  View<const uint32_t> counts;  ///< use by light; other lights were not used
  uint32_t used = 0;            ///< sum of the counts
  float feedback = 0;           ///< weight of use

  RELUME_HD uint32_t operator()(size_t i) const {
    if (i >= power.size || !(power.data[i].pmf > 0.0f)) return 0;
    float share = power.data[i].pmf;
    if (used > 0) {
      const uint32_t count = i < counts.size ? counts.data[i] : 0;
      const float use = static_cast<float>(static_cast<int>(count)) / static_cast<float>(static_cast<int>(used));
      share = (1.0f - feedback) * share + feedback * use;
    }
    return 1 + static_cast<uint32_t>(share * kBudget);
  }
};

/// Fills the list of each tile; one call per tile. Half of a list (with the defaults) are the lights of the tile's
/// pixels, and the rest those of pixels around it, chosen by contribution among four. A pixel without a light gives one
/// of the list that its surface had in the frame before, or else one of all lights.
struct FillTilesKernel {
  View<const LightFeedback> feedback;  ///< by pixel
  uint32_t width = 0;
  uint32_t height = 0;
  TileLists before;  ///< may be empty
  LightProxies all;  ///< not empty
  TileGrid grid;
  uint32_t radius = 0;  ///< largest distance of pixels around the tile from its centre along each axis, pixels
  uint32_t seed = 0;
  View<LightId> lights;
  View<TileDepths> depths;

  RELUME_HD void operator()(uint32_t column, uint32_t row) const {
    const uint32_t tile = row * grid.columns + column;
    ReusableNumber random{0, hash(seed, tile)};
    LightId* const list = lights.data + size_t{tile} * grid.list_size;
    const int left = static_cast<int>(column * grid.tile_size) - static_cast<int>(grid.offset.x);
    const int top = static_cast<int>(row * grid.tile_size) - static_cast<int>(grid.offset.y);
    const uint32_t pixels = grid.tile_size * grid.tile_size;
    const uint32_t inner = relume::min(pixels, grid.list_size);
    for (uint32_t i = 0; i < inner; ++i) {
      // Every pixel once, or a random one of each stratum if there are more pixels than entries.
      const uint32_t first = static_cast<uint32_t>(uint64_t{i} * pixels / inner);
      const uint32_t next = static_cast<uint32_t>((uint64_t{i} + 1) * pixels / inner);
      const uint32_t p = first + below(next - first, random);
      list[i] = light_of_pixel(
          pixel_at(left + static_cast<int>(p % grid.tile_size), top + static_cast<int>(p / grid.tile_size)), random);
    }
    const int half = static_cast<int>(grid.tile_size / 2);
    for (uint32_t i = inner; i < grid.list_size; ++i) {
      const int x = left + half + around(random);
      list[i] = light_of_block(x, top + half + around(random), random);
    }
    sort(list);
    depths[tile] = depths_of(left, top);
  }

 private:
  RELUME_HD static uint32_t below(uint32_t count, ReusableNumber& random) {
    return static_cast<uint32_t>((uint64_t{random.next_bits()} * count) >> 32);
  }
  RELUME_HD int around(ReusableNumber& random) const {
    return static_cast<int>(below(2 * radius + 1, random)) - static_cast<int>(radius);
  }

  /// Mirrors coordinates at the border of the image; those farther outside end at the border.
  RELUME_HD static uint32_t mirrored(int x, uint32_t size) {
    const int last = static_cast<int>(size) - 1;
    if (x < 0) x = -x;
    if (x > last) x = 2 * last - x;
    return static_cast<uint32_t>(x < 0 ? 0 : (x > last ? last : x));
  }
  RELUME_HD uint32_t pixel_at(int x, int y) const { return mirrored(y, height) * width + mirrored(x, width); }

  RELUME_HD bool is_sampled(LightId id) const { return id < all.light_count() && all.run_of(id).count > 0; }
  RELUME_HD bool is_useful(const LightFeedback& f) const { return f.is_direct() && is_sampled(f.id()); }

  RELUME_HD LightId light_of_pixel(uint32_t pixel, ReusableNumber& random) const {
    const LightFeedback& f = feedback[pixel];
    return is_useful(f) ? f.id() : replacement(pixel, random);
  }

  /// The light of one of 2 × 2 pixels, in proportion to their contributions.
  RELUME_HD LightId light_of_block(int x, int y, ReusableNumber& random) const {
    float sum = 0;
    LightId chosen = kNoLight;
    for (int i = 0; i < 4; ++i) {
      const LightFeedback& f = feedback[pixel_at(x + (i & 1), y + (i >> 1))];
      if (!is_useful(f) || !(f.weight > 0.0f)) continue;
      sum += f.weight;
      if (to_unit_float(random.next_bits()) * sum < f.weight) chosen = f.id();
    }
    return chosen != kNoLight ? chosen : replacement(pixel_at(x, y), random);
  }

  /// A light for a pixel without one.
  RELUME_HD LightId replacement(uint32_t pixel, ReusableNumber& random) const {
    const uint32_t tile = tile_before(pixel);
    if (tile != kNoTile) {
      const LightId light = before.light(tile, below(before.grid.list_size, random));
      if (is_sampled(light)) return light;
    }
    return all.owner(below(all.total(), random));
  }

  /// The tile that a pixel's surface had in the frame before. A pixel without a surface has that of the same place.
  RELUME_HD uint32_t tile_before(uint32_t pixel) const {
    if (before.grid.count() == 0) return kNoTile;
    const LightFeedback& f = feedback[pixel];
    return f.has_surface() ? before.find(f.previous_position) : before.grid.tile_of(pixel % width, pixel / width);
  }

  /// Distances of the tile's surfaces. Without any, those of the same place in the frame before.
  RELUME_HD TileDepths depths_of(int left, int top) const {
    const int size = static_cast<int>(grid.tile_size);
    TileDepths result;
    for (int y = top; y < top + size; ++y) {
      for (int x = left; x < left + size; ++x) {
        if (x < 0 || y < 0 || x >= static_cast<int>(width) || y >= static_cast<int>(height)) continue;
        const LightFeedback& f = feedback[static_cast<uint32_t>(y) * width + static_cast<uint32_t>(x)];
        if (f.has_surface()) result.add(distance_from(grid.camera, f.position));
      }
    }
    if (!result.empty() || before.grid.count() == 0) return result;
    const uint32_t pixel = pixel_at(left + size / 2, top + size / 2);
    return before.depths[before.grid.tile_of(pixel % width, pixel / width)];
  }

  /// Sorts a list in place by the gaps of [Ciura01].
  RELUME_HD void sort(LightId* list) const {
    constexpr uint32_t kGaps[] = {301, 132, 57, 23, 10, 4, 1};
    for (const uint32_t gap : kGaps) {
      for (uint32_t i = gap; i < grid.list_size; ++i) {
        const LightId light = list[i];
        uint32_t k = i;
        for (; k >= gap && list[k - gap] > light; k -= gap) list[k] = list[k - gap];
        list[k] = light;
      }
    }
  }
};

}  // namespace relume
