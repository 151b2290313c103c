// More camera rays for pixels at the edges of light sources, whose emission is not filtered.
#pragma once

#include "techniques/gbuffer/primary_hits/emission_edges.h"
#include "techniques/radiance_cache/path_space_filter/filtered_pixel.h"
#include "techniques/transport/path/walk.h"

namespace relume {

/// Finds pixels at the edges of light sources and estimates their mean emission.
struct CellEdges {
  PathContext context;
  SampleIndex index;
  View<const FilteredPixel> pixels;
  View<const OtherCells> others;  ///< as FilterContext::others
  uint32_t rays = 0;              ///< camera rays per pixel at an edge; 0: no pixel has more
  uint32_t width = 0;
  uint32_t height = 0;

  /// Whether pixel (x, y) is at the edge of a light source.
  RELUME_HD bool contains(const HashGridView& grid, uint32_t x, uint32_t y) const {
    const float contrast =
        emission_contrast(x, y, width, height, [&](uint32_t i) { return luminance(pixels[i].seen); });
    if (!(contrast > 0.0f)) return false;
    const auto radiance = [&](uint32_t i) { return luminance(shown(grid, i)); };
    return contrast > kEmissionContrast * darkest_around(x, y, width, height, radiance);
  }

  /// Mean emission within pixel (x, y).
  RELUME_HD Rgb emission(uint32_t x, uint32_t y) const {
    NoPolicy policy;
    return mean_emission(index, rays, x, y, [&](Sampler& sampler) {
      PathState path = start_path(context, x, y, sampler);
      SurfacePoint sp;
      sp.position = path.ray.origin;
      sp.bsdf.lobe_count = 0;  // the camera
      const Hit hit = intersect_from_camera(context.scene, path.ray, sampler.camera_ray_id());
      arrive(context, hit, sp, path, policy);
      return path.radiance;
    });
  }

 private:
  RELUME_HD Rgb shown(const HashGridView& grid, uint32_t i) const {
    const FilteredPixel& p = pixels[i];
    if (!p.filtered) return p.seen;
    // The path may have missed a cell that another thread inserted later, so kNoCell is looked up again.
    const uint32_t slot = grid.find(p.point, p.slot);
    const Rgb shown = p.seen + p.factor * grid.own_moments(slot).mean;
    if (!p.split) return shown;
    const OtherCells& other = others[i];
    const uint32_t specular = grid.find(other.specular_point(p.point), other.specular_slot);
    return shown + other.specular_factor * grid.own_moments(specular).mean;
  }
};

}  // namespace relume
