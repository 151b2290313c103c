// Path space filtering ([Binder19], [Schipek22 §2.4]). The filtered vertex of a path is the first that is not nearly
// specular. Its radiance is divided by the albedo and added to a cell of the hash grid. The pixel shows the cell's
// mean.
#pragma once

#include "techniques/radiance_cache/path_space_filter/cell_edges.h"
#include "techniques/radiance_cache/path_space_filter/cell_paths.h"
#include "techniques/radiance_cache/path_space_filter/demodulate.h"
#include "techniques/transport/path/specular_part.h"

namespace relume {

class FilterVertex;

/// Share of the albedo below which diffuse or specular lobes get no cell of their own.
inline constexpr float kSmallestPart = 0.01f;

/// Parameters shared by all paths.
struct FilterContext {
  using Policy = FilterVertex;

  HashGridView grid;
  float narrow_alpha = 0.04f;  ///< α below which lobes are not filtered
  bool split = false;          ///< whether diffuse and specular lobes have cells of their own ([Binder19] §3.1.2)
  bool refine = false;         ///< whether finer cells receive samples, too
  View<OtherCells> others;     ///< by pixel, with `split` or `refine`; else empty
  uint32_t width = 0;          ///< pixels per row of `others`
  bool by_prefix = false;      ///< for light paths: whether primary hits have cells of their own, because their samples
                               ///< lack the light of splats, those of vertices behind mirrors do not. Behind a wide
                               ///< lobe, weights depend on its vertex, so no vertex there is filtered
  bool direct_apart = false;   ///< whether primary hits have cells of their own, because reservoirs add their direct
                               ///< light
  /// Whether reservoirs add the indirect light of primary hits, which cells of primary hits then lack. Later vertices
  /// of such paths are not filtered.
  bool indirect_apart = false;
  /// Whether reservoirs add all light that lobes with a density scatter. No vertex of other paths is filtered: cells
  /// hold no light of delta lobes.
  bool whole_apart = false;

  RELUME_HD bool separates_primary() const { return by_prefix || direct_apart || indirect_apart; }
  RELUME_HD FilterVertex policy(const SampleIndex& index, uint32_t x, uint32_t y) const;
};

/// Finds the filtered vertex of a path, and adds the radiance of the rest of the path to a cell. A path that leaves
/// this vertex through a delta lobe continues as usual; the radiance beyond stays outside the cell.
class FilterVertex : public NoPolicy {
 public:
  static constexpr bool resamples_lights = true;

  FilterVertex() = default;
  RELUME_HD FilterVertex(const FilterContext& context, const SampleIndex& index, uint32_t x, uint32_t y)
      : context_(&context), index_(&index), x_(x), y_(y) {}

  RELUME_HD bool reached() const { return pixel_.filtered; }
  RELUME_HD FilteredPixel& pixel() { return pixel_; }
  /// The pixel's other cells. Only with split or finer cells.
  RELUME_HD OtherCells& others() const { return context_->others[y_ * context_->width + x_]; }

  template <typename Earlier>
  RELUME_HD bool arrived(SurfacePoint& sp, PathState& path, Earlier& earlier) {
    if (path.bounce == 0) pixel_.seen = path.radiance;
    scatters_ = true;
    // Paths behind a dispersive interface differ in wavelength, over which a cell would average.
    if (reached() || path.dispersed || (context_->by_prefix && widened_) || left_to_reservoirs_) return true;
    if (context_->whole_apart) return true;
    const Demodulation d = demodulate(sp.bsdf, sp.wo_local.z, context_->narrow_alpha);
    if (!d.filtered) return true;
    pixel_.filtered = true;
    pixel_.divided = d.has_delta;
    pixel_.unfiltered = path.radiance;
    pixel_.factor = path.throughput * d.albedo;
    const Vec2 jitter = filter_random_2d(*index_, x_, y_, 0);
    const uint16_t layer = context_->separates_primary() && path.bounce > 0 ? kBehindLayer : uint16_t{0};
    pixel_.point = context_->grid.keys.point(sp, jitter, layer, d.glossy, 0, d.roughness);
    if (context_->split || context_->refine) find_others(d, path.throughput, sp.position);
    context_->grid.prefetch_sums(context_->grid.keys.address(pixel_.point));
    anchor_ = path.throughput * d.divisor();
    earlier.rebased(path.radiance, path.throughput * d.albedo);
    path.radiance = Rgb(0);
    path.throughput = 1.0f / d.divisor();
    // Russian roulette compares with the throughput after this vertex, about 1.
    path.rr_reference = 1.0f;
    path.eta_scale = 1.0f;
    return true;
  }

  RELUME_HD void connected(const SurfacePoint& sp, const PathState&, const Connection& c, bool visible) {
    if (visible && pixel_.split && !left_) others().specular += c.contribution * specular_share(sp, c.ray.direction);
  }

  template <typename Earlier>
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample& s, PathState& path, Earlier& earlier) {
    left_to_reservoirs_ = left_to_reservoirs_ || (context_->indirect_apart && path.bounce == 1 && !path.delta);
    if (!reached()) widened_ = widened_ || (!path.delta && s.alpha >= context_->narrow_alpha);
    if (!reached() || left_) return;
    left_ = true;
    if (!path.delta) {
      if (!pixel_.split) return;
      others().share = specular_share(sp, s.wi);
      others().before = path.radiance;
      return;
    }
    apart_ = true;
    sample_ = path.radiance;
    earlier.rebased(sample_, Rgb(1));
    path.radiance = Rgb(0);
    path.throughput *= anchor_;
    path.rr_reference *= max_component(anchor_);
  }

  /// Radiance that the finished path found since its filtered vertex, in units of its throughput there.
  RELUME_HD Rgb found(const PathState& path) const { return path.radiance; }
  /// Every path samples a direction.
  RELUME_HD float scatter_chance() const { return 1.0f; }

  /// Adds the path's sample to the cell.
  RELUME_HD void finished(const PathState& path) {
    if (!reached()) {
      pixel_.unfiltered = path.radiance;
      if (!scatters_) pixel_.seen = path.radiance;
      return;
    }
    if (!apart_) sample_ = path.radiance;
    if (apart_) pixel_.unfiltered += path.radiance;
    if (pixel_.culled) return;
    const float u = filter_random(*index_, x_, y_, 0);
    if (pixel_.split) return insert_parts(path, u);
    pixel_.slot = context_->grid.insert(pixel_.point, sample_, 1.0f / pixel_.survival, u, pixel_.slot);
    insert_finer(sample_);
    if (is_finite(sample_)) pixel_.traced = pixel_.factor * sample_;
  }

 private:
  RELUME_HD void find_others(const Demodulation& d, const Rgb& throughput, const Vec3& position) {
    const HashGridView& grid = context_->grid;
    others() = {};
    if (context_->split) split(d, throughput);
    if (context_->refine) others().finer = finer_offset(grid.keys, pixel_.point, position);
    if (pixel_.split) grid.prefetch_sums(grid.keys.address(others().specular_point(pixel_.point)));
  }

  /// Gives diffuse and specular lobes a cell each, unless one of them reflects hardly anything.
  RELUME_HD void split(const Demodulation& d, const Rgb& throughput) {
    const float specular = luminance(d.specular);
    const float all = luminance(d.albedo);
    pixel_.split = relume::min(specular, all - specular) > kSmallestPart * all;
    if (!pixel_.split && specular > 0.5f * all) {
      pixel_.point.layer = static_cast<uint16_t>(pixel_.point.layer | kSpecularLayer);
      return;
    }
    others().specular_direction = pixel_.point.direction;
    pixel_.point.direction = 0;
    if (!pixel_.split) return;
    pixel_.factor = throughput * glm::max(d.albedo - d.specular, Rgb(0));
    others().specular_factor = throughput * d.specular;
    others().to_diffuse = d.divisor() / positive_or_one(d.raised - d.specular);
    others().to_specular = d.divisor() / positive_or_one(d.specular);
  }

  RELUME_HD void insert_finer(const Rgb& sample) const {
    if (!context_->refine) return;
    const HashGridView& grid = context_->grid;
    grid.insert_finer(finer_point(grid.keys, pixel_.point, others().finer), sample, 1.0f / pixel_.survival);
  }

  /// Adds the diffuse and the specular part of the path's sample to their cells.
  RELUME_HD void insert_parts(const PathState& path, float u) {
    OtherCells& other = others();
    if (left_ && !apart_) other.specular += (path.radiance - other.before) * other.share;
    const Rgb diffuse = glm::max(sample_ - other.specular, Rgb(0)) * other.to_diffuse;
    const Rgb specular = other.specular * other.to_specular;
    const float weight = 1.0f / pixel_.survival;
    const HashGridView& grid = context_->grid;
    pixel_.slot = grid.insert(pixel_.point, diffuse, weight, u, pixel_.slot);
    insert_finer(diffuse);
    const CellPoint point = other.specular_point(pixel_.point);
    other.specular_slot = grid.insert(point, specular, weight, u, other.specular_slot);
    if (is_finite(diffuse) && is_finite(specular))
      pixel_.traced = pixel_.factor * diffuse + other.specular_factor * specular;
  }

  const FilterContext* context_ = nullptr;
  const SampleIndex* index_ = nullptr;
  uint32_t x_ = 0;
  uint32_t y_ = 0;
  FilteredPixel pixel_;
  Rgb anchor_{0};  ///< ratio of true to demodulated throughput after the vertex
  Rgb sample_{0};
  bool scatters_ = false;            ///< whether the path has hit a surface
  bool widened_ = false;             ///< whether the path left an earlier vertex through a wide lobe
  bool left_to_reservoirs_ = false;  ///< whether reservoirs take the light of later vertices
  bool left_ = false;
  bool apart_ = false;  ///< whether the path left through a delta lobe
};

RELUME_HD inline FilterVertex FilterContext::policy(const SampleIndex& index, uint32_t x, uint32_t y) const {
  return {*this, index, x, y};
}

/// Traces one path per pixel and fills the cells.
using PathSpaceFilterKernel = CellPathsKernel<FilterContext>;

/// Layers that show the cell of each pixel; empty views are not written. Pixels that are not filtered have 0.
struct CellLayers {
  View<uint32_t> identity;  ///< hash of the cell's fingerprint
  View<float> level;        ///< log2 of the edge in metres
  View<float> count;        ///< number of samples
  View<float> age;          ///< frames with samples since the cell started
  View<float> variance;     ///< variance of a sample's luminance
  View<float> survival;     ///< probability of following the path
  View<float> blend;        ///< share of the cell in the pixel
  View<float> termination;  ///< bounce, from 1, at which the path's contribution ended; 0: not recorded
  View<float> occupancy;    ///< share of occupied slots near the cell's slot
};

/// Computes pixels from paths and cells, whose moments include all samples of the frame.
struct ResolveCellsKernel {
  HashGridView grid;
  View<const FilteredPixel> pixels;
  View<Rgb> radiance;
  CellLayers layers;
  uint32_t width = 0;
  CellEdges edges;
  View<uint32_t> rays;                   ///< rays of this sample, to which edge rays are added
  float refine = 0;                      ///< standard errors by which a finer cell must differ to be shown; 0: never
  View<const OtherCells> others;         ///< as FilterContext::others
  View<const uint32_t> allocation = {};  ///< paths of the pixel, 0 or 1; empty: 1
  bool adds = false;                     ///< whether `radiance` holds light that no cell contains: splats of light
                                         ///< paths, or the light of reservoirs
  View<Rgb> from_cells = {};             ///< part of the radiance that comes from cells; may be empty

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t i = y * width + x;
    const FilteredPixel& p = pixels[i];
    CellMoments cell;
    Rgb outside = p.unfiltered;
    if (adds) outside += radiance[i];
    Rgb value = outside;
    if (p.filtered) {
      const uint32_t slot = grid.find(p.point, p.slot);
      if (p.blend > 0.0f || !layers.count.empty()) cell = grid.moments(p.point, slot);
      value += p.blend * shown(i, cell);
      if (p.blend < 1.0f) value += (1.0f - p.blend) * p.traced;
      write_cell(i, p, slot);
    } else {
      leave_out(i);
    }
    write(from_cells, i, value - outside);
    if (edges.rays > 0 && is_sampled(i) && edges.contains(grid, x, y)) {
      value += edges.emission(x, y) - p.seen;
      rays[i] += edges.rays;
    }
    radiance[i] = value;
    write(layers.count, i, cell.count);
    write(layers.variance, i, cell.variance());
    write(layers.survival, i, p.filtered ? p.survival : 0.0f);
    write(layers.blend, i, p.filtered ? p.blend : 0.0f);
    write(layers.termination, i, static_cast<float>(p.termination));
  }

 private:
  RELUME_HD bool is_sampled(uint32_t i) const { return allocation.empty() ? rays[i] > 0 : allocation[i] > 0; }

  /// Reflected radiance by the cells of pixel `i`; `cell`: the (diffuse) one. The path's own where a cell has no
  /// samples.
  RELUME_HD Rgb shown(uint32_t i, const CellMoments& cell) const {
    const FilteredPixel& p = pixels[i];
    if (!(cell.count > 0.0f)) return p.traced;
    const Rgb diffuse = p.factor * refined(i, cell);
    if (!p.split) return diffuse;
    const OtherCells& other = others[i];
    const CellPoint point = other.specular_point(p.point);
    const CellMoments specular = grid.moments(point, grid.find(point, other.specular_slot));
    return specular.count > 0.0f ? diffuse + other.specular_factor * specular.mean : p.traced;
  }

  /// Mean of the (diffuse) cell `cell`, moved to that of the finer cell by the share of their squared difference that
  /// exceeds the noise of the latter. Its own variance alone is too low if it missed rare bright samples: the pixel
  /// would be too dark.
  RELUME_HD Rgb refined(uint32_t i, const CellMoments& cell) const {
    if (!(refine > 0.0f)) return cell.mean;
    const CellPoint point = finer_point(grid.keys, pixels[i].point, others[i].finer);
    const CellMoments finer = grid.own_moments(grid.find(grid.keys.address(point, -1)));
    if (grid.undersampled(finer)) return cell.mean;
    const float difference = sqr(luminance(finer.mean) - luminance(cell.mean));
    const float noise = sqr(refine) * relume::max(finer.variance(), cell.variance()) / finer.count;
    return difference > noise ? finer.mean + (cell.mean - finer.mean) * (noise / difference) : cell.mean;
  }

  template <typename T>
  RELUME_HD static void write(const View<T>& view, uint32_t i, T value) {
    if (!view.empty()) view[i] = value;
  }

  RELUME_HD void write_cell(uint32_t i, const FilteredPixel& p, uint32_t slot) const {
    if (!layers.level.empty()) layers.level[i] = static_cast<float>(grid.keys.level_of(p.point));
    write(layers.age, i, slot == kNoCell ? 0.0f : static_cast<float>(grid.histories[slot].frames));
    if (layers.identity.empty() && layers.occupancy.empty()) return;
    const CellAddress address = grid.address(p.point, slot);
    write(layers.identity, i,
          hash(static_cast<uint32_t>(address.fingerprint), static_cast<uint32_t>(address.fingerprint >> 32)));
    if (!layers.occupancy.empty()) layers.occupancy[i] = grid.occupancy(address);
  }

  RELUME_HD void leave_out(uint32_t i) const {
    write(layers.identity, i, 0u);
    write(layers.level, i, 0.0f);
    write(layers.age, i, 0.0f);
    write(layers.occupancy, i, 0.0f);
  }
};

}  // namespace relume
