// The lists of tiles and the proxies of all lights, which each frame builds from the feedback of the last.
#pragma once

#include <iosfwd>

#include "core/array.h"
#include "frame/launch.h"
#include "frame/primitives/primitive.h"
#include "techniques/light_sampling/adaptive_tiles/fill_tiles.h"

namespace relume {

/// Shape of the lists.
struct TileOptions {
  uint32_t tile_size = 8;    ///< pixels
  uint32_t list_size = 128;  ///< entries
  uint32_t radius = 16;      ///< as in FillTilesKernel
  bool jitter = true;        ///< whether each frame shifts the grid
  float depth_tolerance = 1.5f;
};

/// The feedback of a frame.
struct FrameFeedback {
  View<const LightFeedback> pixels;
  uint32_t width = 0;
  uint32_t height = 0;
  CameraView camera = {};  ///< of that frame
};

/// Whether the projection is known and the axes have about unit length, so that points have raster positions or none.
/// False only for cameras from damaged checkpoints.
bool is_undamaged(const CameraView& camera);

class LearnedTiles {
 public:
  explicit LearnedTiles(Memory& memory) : lights_(memory), depths_(memory), proxies_(memory) {}

  /// A copy, by launches.
  LearnedTiles copy(Backend& backend) const;

  /// Replaces the proxies. `power`: entries of build_power_lights(); `counts`: use by light, whose sum is `used`.
  void build_proxies(const PrimitiveLaunch& at, View<const AliasEntry> power, View<const uint32_t> counts,
                     uint32_t used, float feedback);
  /// Replaces the lists by those of `feedback`, after build_proxies(). `before`: those of the feedback of the frame
  /// before, from which its paths chose except in epochs of several frames. Without proxies, there are no lists.
  /// `seed`: different in each frame.
  void fill(Backend& backend, const FrameFeedback& feedback, const LearnedTiles& before, const TileOptions& options,
            uint32_t seed);
  /// Removes the lists.
  void clear_lists();
  /// Exchanges the lists, but not the proxies.
  void swap_lists(LearnedTiles& other) noexcept;

  TileLists lists(float depth_tolerance) const { return {grid_, depth_tolerance, lights_.view(), depths_.view()}; }
  LightProxies proxies() const { return {proxies_.view()}; }
  const TileGrid& grid() const { return grid_; }
  /// Entries of all lists, for host code.
  std::span<const LightId> read_lights() const { return lights_.read(); }

  /// Whether the lists fit an image of this size and the proxies this number of lights; false after damage. Reads
  /// arrays on the host.
  bool consistent(uint32_t width, uint32_t height, uint32_t light_count) const;

  size_t memory_bytes() const { return lights_.memory_bytes() + depths_.memory_bytes() + proxies_.memory_bytes(); }
  void save(std::ostream& out) const;
  void load(std::istream& in);

 private:
  TileGrid grid_;
  Array<LightId> lights_;
  Array<TileDepths> depths_;
  Array<uint32_t> proxies_;
};

}  // namespace relume
