// Completes the records of first vertices where camera subpaths fill cells, as FirstLightKernel does where they do not.
#pragma once

#include "techniques/radiance_cache/path_space_filter/filtered_pixel.h"
#include "techniques/transport/bdpt/first_light_kernel.h"

namespace relume {

/// Records the light of each first vertex with one or two directions. Where the pixel shows the cell of its primary
/// hit, FirstVertex::scatter and ::indirect have the light of the camera subpath, ::to_light and ::direct that of
/// splats. A history looks up the former in the cell from a new view, and tests the latter. Elsewhere, ::scatter and
/// ::indirect have all light, as without a cache.
struct FirstLightOfCellsKernel {
  BdptContext context;
  SampleIndex index;
  View<const Hit> hits;
  View<const uint32_t> allocation;  ///< paths of the pixel, 0 or 1; empty: 1
  View<const Rgb> splats;           ///< radiance of the splats of this sample
  View<const FilteredPixel> pixels;
  View<uint32_t> cells_at_hit;  ///< kCellsAtHit

  RELUME_HD void operator()(uint32_t x, uint32_t y) const {
    const uint32_t pixel = y * context.width + x;
    const Hit& hit = hits[pixel];
    cells_at_hit[pixel] = 0;
    if ((!allocation.empty() && allocation[pixel] == 0) || !hit.valid()) return;
    Sampler sampler = index.sampler(x, y);
    SurfacePoint sp;
    if (!surface_of_record(context, x, y, hit, sampler, sp)) return;
    const FilteredPixel& p = pixels[pixel];
    cells_at_hit[pixel] = p.filtered && (p.point.layer & kBehindLayer) == 0 ? 1u : 0u;
    FirstVertex& vertex = context.first_light.vertices[pixel];
    if (context.path.first_nee_bounce == 0) record_light(context, sp, sampler, vertex);
    // Reflection by Lambertian surfaces is the same in all directions.
    if (!is_lambert(sp.bsdf)) record_directions(sp, hit, pixel, vertex);
  }

 private:
  RELUME_HD void record_directions(const SurfacePoint& sp, const Hit& hit, uint32_t pixel, FirstVertex& vertex) const {
    const FilteredPixel& p = pixels[pixel];
    const FirstLight& first = context.first_light;
    const Rgb transmittance = transmittance_to_camera(context.scene(), sp, hit);
    // Surviving subpaths also represent culled ones.
    const Rgb traced = p.traced / p.survival;
    if (cells_at_hit[pixel] == 0) {
      // The choice among both kinds: the largest key wins.
      const uint64_t of_splats = first.splats[pixel];
      const uint64_t chosen = of_splats > first.chosen[pixel] ? of_splats : first.chosen[pixel];
      const Rgb reflected = p.unfiltered + traced + splats[pixel] - transmittance * sp.emission;
      return set(light_along(sp, chosen, transmittance, reflected), vertex.scatter, vertex.indirect);
    }
    set(light_along(sp, first.chosen[pixel], transmittance, traced), vertex.scatter, vertex.indirect);
    // Without a splat in this frame, the light sample's direction stays, and also tests splats of other frames.
    if (first.splats[pixel] == 0 && length_squared(vertex.to_light) > 0.0f) return;
    set(light_along(sp, first.splats[pixel], transmittance, splats[pixel]), vertex.to_light, vertex.direct);
  }

  RELUME_HD static void set(const ChosenLight& light, Vec3& direction, Rgb& arriving) {
    direction = light.direction;
    arriving = light.arriving;
  }
};

}  // namespace relume
