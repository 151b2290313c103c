// Update paths of the spatially hashed radiance cache [Sharc25]. Few pixels trace one. The first vertices add a sample
// to their cells: their direct light, that of later vertices, and the radiance of the cell in which the path ends. That
// cell is of earlier frames, so light propagates over any number of bounces.
#pragma once

#include "techniques/radiance_cache/sharc/sharc_cells.h"
#include "techniques/spatial/octree/region_lookup.h"
#include "techniques/transport/path/path_kernel.h"

namespace relume {

/// Edge of the blocks of pixels of which one traces an update path.
inline constexpr uint32_t kUpdateBlock = 5;
RELUME_HD constexpr uint32_t update_blocks(uint32_t size, uint32_t block) { return (size + block - 1) / block; }

/// Maximum number of samples that wait for the light of later vertices.
inline constexpr uint32_t kMostPropagation = 8;
/// Maximum number of cells of an update path without feedback, which discards incomplete samples at the next one.
inline constexpr uint32_t kMostUpdatedCells = 8;
/// Minimum bounce limit of update paths, for any limit of camera paths. The samples of a path that ends at a limit
/// lack light.
inline constexpr uint32_t kLeastUpdateBounces = 2 * kMostUpdatedCells;

/// Share of light from a later vertex that a cell receives, for light of luminance `y`. The limit is `clamp` times the
/// cell's mean for cells of 12 samples, and falls to half of it for cells of two. Cells of fewer samples have no limit.
RELUME_HD inline float clamped_share(float clamp, const CellMoments& cell, float y) {
  constexpr float kNoConfidence = 2;
  constexpr float kFullConfidence = 12;
  const float mean = luminance(cell.mean);
  if (!(cell.count > kNoConfidence) || !(mean > 0.0f)) return 1.0f;
  const float confidence = saturate((cell.count - kNoConfidence) / (kFullConfidence - kNoConfidence));
  const float limit = clamp * (0.5f + 0.5f * confidence) * mean;
  return y > limit ? limit / y : 1.0f;
}

/// Constants of all update paths.
struct CellUpdateContext {
  SharcCells cells;
  uint32_t depth = 4;         ///< cells that wait for later light, 2 to kMostPropagation
  bool feedback = true;       ///< whether paths end in known cells
  float clamp = 0;            ///< as for clamped_share(); 0: no clamping
  bool inherits = false;      ///< whether new cells inherit moments from the next level
  RegionLookup regions = {};  ///< look-up of the region of each vertex; empty without techniques that learn per region
};

/// The policy of one update path. Between two vertices with cells, the path's throughput and radiance are relative to
/// the demodulated first of them.
class CellUpdate : public NoPolicy {
 public:
  CellUpdate() = default;
  RELUME_HD CellUpdate(const CellUpdateContext& context, const SampleIndex& index, uint32_t x, uint32_t y)
      : context_(&context), index_(&index), x_(x), y_(y) {}

  RELUME_HD bool arrived(SurfacePoint& sp, const PathState& path) {
    sp.region = context_->regions.region_at(sp);
    has_cell_ = false;
    if (!SharcCells::may_hold(sp, path)) return true;
    const Demodulation d = demodulate(sp.bsdf, sp.wo_local.z, context_->cells.narrow_alpha);
    if (!d.filtered) return true;
    has_cell_ = true;
    point_ = context_->cells.point(sp, filter_random_2d(*index_, x_, y_, kJitterPurpose + path.bounce));
    address_ = grid().keys.address(point_);
    grid().prefetch_moments(address_);
    albedo_here_ = d.albedo;
    divisor_ = d.divisor();
    return true;
  }

  RELUME_HD bool goes_on(PathState& path) {
    if (!has_cell_) return true;
    settle(path);
    const uint32_t slot = grid().find(address_);
    const CellMoments cell = grid().own_moments(slot);
    if (ends_in(cell)) {
      advance(path.throughput);
      const Rgb leaving = albedo_here_ * cell.mean;
      for (uint32_t i = 0; i < count_; ++i) add_later(samples_[i], leaving);
      return false;
    }
    if (count_ == context_->depth) {
      if (context_->feedback) return true;  // the waiting samples receive the light of all later vertices
      insert_oldest();
    }
    advance(path.throughput);
    if (updated_ == kMostUpdatedCells) {
      count_ = 0;  // these samples lack light of later vertices
      return false;
    }
    samples_[count_++] = {point_, slot, Rgb(0), Rgb(1)};
    ++updated_;
    grid().prefetch_sums(address_);
    albedo_ = albedo_here_;
    path.throughput = 1.0f / divisor_;
    // Russian roulette compares with the throughput after this vertex, about 1.
    path.rr_reference = 1.0f;
    path.eta_scale = 1.0f;
    return true;
  }

  /// Adds the waiting samples to their cells.
  RELUME_HD void finished(PathState& path) {
    settle(path);
    for (uint32_t i = 0; i < count_; ++i) insert(samples_[i]);
    count_ = 0;
  }

 private:
  /// Sample of a cell that still receives light of later vertices. Has no initial values, because a path has space for
  /// many.
  struct Sample {
    CellPoint point;
    uint32_t slot;  ///< slot of the cell, or kNoCell
    Rgb value;
    Rgb transport;  ///< factor of radiance that leaves the last vertex with a cell
  };
  // Purposes of random numbers, apart from those of other caches and of camera paths.
  static constexpr uint32_t kJitterPurpose = 0x4000;
  static constexpr uint32_t kEndPurpose = 0x6000;

  RELUME_HD const HashGridView& grid() const { return context_->cells.grid; }

  /// Adds the radiance found since the last vertex with a cell to the waiting samples.
  RELUME_HD void settle(PathState& path) {
    const Rgb found = path.radiance;
    path.radiance = Rgb(0);
    if (count_ == 0) return;
    samples_[count_ - 1].value += found;
    const Rgb leaving = albedo_ * found;
    for (uint32_t i = 0; i + 1 < count_; ++i) add_later(samples_[i], leaving);
  }

  /// Advances from the last vertex with a cell to the current one. `throughput`: between both.
  RELUME_HD void advance(const Rgb& throughput) {
    if (count_ == 0) return;
    const Rgb step = albedo_ * throughput;
    for (uint32_t i = 0; i + 1 < count_; ++i) samples_[i].transport *= step;
    samples_[count_ - 1].transport = throughput;
  }

  RELUME_HD void add_later(Sample& sample, const Rgb& leaving) const {
    Rgb light = sample.transport * leaving;
    if (context_->clamp > 0.0f)
      light *= clamped_share(context_->clamp, grid().own_moments(sample.slot), luminance(light));
    sample.value += light;
  }

  /// Whether the path ends in a cell: after a random number of other cells from 1 to depth − 1, if it is known.
  RELUME_HD bool ends_in(const CellMoments& cell) const {
    if (!context_->feedback || count_ == 0 || grid().undersampled(cell)) return false;
    const float u = filter_random(*index_, x_, y_, kEndPurpose + updated_);
    const uint32_t least = math::truncate_to_uint(1.5f + u * static_cast<float>(context_->depth - 2u));
    return least <= count_;
  }

  RELUME_HD void insert_oldest() {
    insert(samples_[0]);
    for (uint32_t i = 1; i < count_; ++i) samples_[i - 1] = samples_[i];
    --count_;
  }

  RELUME_HD void insert(const Sample& sample) const {
    grid().insert(sample.point, sample.value, 1.0f, 0.0f, sample.slot, !context_->inherits);
  }

  const CellUpdateContext* context_ = nullptr;
  const SampleIndex* index_ = nullptr;
  uint32_t x_ = 0;
  uint32_t y_ = 0;
  // The current vertex.
  CellPoint point_;
  CellAddress address_;
  Rgb albedo_here_{0};
  Rgb divisor_{1};
  bool has_cell_ = false;
  Rgb albedo_{0};         ///< of the last vertex with a cell
  uint32_t updated_ = 0;  ///< cells to which the path adds a sample
  uint32_t count_ = 0;    ///< waiting samples
  Sample samples_[kMostPropagation];
};

/// Traces the update paths of a frame from its primary hits, and fills the cells. Grid: blocks of pixels.
struct CellUpdateKernel {
  PathContext context;
  CellUpdateContext update;
  SampleIndex index;  ///< of the camera rays
  SampleIndex paths;  ///< of the paths, which are independent of those that the image shows
  View<const Hit> hits;
  View<const uint32_t> allocation;  ///< paths of the pixel, 0 or 1; empty: 1
  View<uint32_t> rays;              ///< per pixel, to which those of the update are added
  uint32_t block = kUpdateBlock;    ///< edge of a block
  uint32_t width = 0;
  uint32_t height = 0;

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = pixel_in(x, y);
    if (pixel == kNoPixel) return;
    const uint32_t px = pixel % width;
    const uint32_t py = pixel / width;
    Sampler sampler = paths.sampler(px, py);
    PathState path = start(px, py);
    CellUpdate policy(update, paths, px, py);
    SurfacePoint sp;
    sp.position = path.ray.origin;
    sp.bsdf.lobe_count = 0;  // the camera
    walk(context, hits[pixel], sp, path, sampler, policy);
    count_rays(pixel, path);
  }

  /// Host: traces several paths of the tile side by side.
  void operator()(const Tile& tile) const {
    PathBatch b;
    CellUpdate policies[PathBatch::kSize];
    uint32_t pixels[PathBatch::kSize];
    uint32_t count = 0;
    for (uint32_t y = tile.y0; y < tile.y1; ++y) {
      for (uint32_t x = tile.x0; x < tile.x1; ++x) {
        const uint32_t pixel = pixel_in(x, y);
        if (pixel == kNoPixel) continue;
        const uint32_t px = pixel % width;
        const uint32_t py = pixel / width;
        pixels[count] = pixel;
        b.active[count] = count;
        b.hits[count] = hits[pixel];
        b.samplers[count] = paths.sampler(px, py);
        b.paths[count] = start(px, py);
        policies[count] = CellUpdate(update, paths, px, py);
        if (++count == PathBatch::kSize) finish(b, policies, pixels, count);
      }
    }
    finish(b, policies, pixels, count);
  }

 private:
  static constexpr uint32_t kNoPixel = 0xffffffffu;

  /// A random pixel of a block that has a sample and a surface; kNoPixel if no pixel of the block has a sample, or that
  /// pixel has no surface.
  RELUME_HD uint32_t pixel_in(uint32_t x, uint32_t y) const {
    const uint32_t x0 = x * block;
    const uint32_t y0 = y * block;
    const uint32_t columns = relume::min(block, width - x0);
    const uint32_t pixels = columns * relume::min(block, height - y0);
    const uint32_t first = hash(hash(paths.seed, paths.frame), x, y) % pixels;
    for (uint32_t k = 0; k < pixels; ++k) {
      const uint32_t i = (first + k) % pixels;
      const uint32_t pixel = (y0 + i / columns) * width + x0 + i % columns;
      if (!allocation.empty() && allocation[pixel] == 0) continue;
      return hits[pixel].valid() ? pixel : kNoPixel;
    }
    return kNoPixel;
  }

  /// The path before its primary hit, with the camera ray of the frame.
  RELUME_HD PathState start(uint32_t x, uint32_t y) const {
    Sampler camera = index.sampler(x, y);
    return start_path(context, x, y, camera);
  }

  /// The camera ray is traced for the image, too.
  RELUME_HD void count_rays(uint32_t pixel, const PathState& path) const { rays[pixel] += path.rays - 1; }

  /// Traces the first `count` paths of the batch, and empties it.
  void finish(PathBatch& b, CellUpdate* policies, const uint32_t* pixels, uint32_t& count) const {
    b.count = count;
    path_batch::trace(context, b, policies, [] {});
    for (uint32_t i = 0; i < count; ++i) {
      policies[i].finished(b.paths[i]);
      count_rays(pixels[i], b.paths[i]);
    }
    count = 0;
  }
};

}  // namespace relume
