// Outputs for the indirect light of reservoirs: planes of the image, and the records by which histories verify the
// light for another viewpoint.
#pragma once

#include "techniques/reuse/reservoir/reuse_image.h"
#include "techniques/reuse/restir_gi/reconnection.h"
#include "techniques/transport/path/first_vertex.h"
#include "techniques/transport/path/specular_part.h"

namespace relume {

/// Adds light from another direction to a record of a first vertex. The record stores one direction: each of the two
/// with a probability proportional to the luminance of the light that it reflects. Its light is scaled to the luminance
/// of both, so the mean over many records is the sum for both directions. `arriving`: as FirstVertex::indirect, along
/// `wi`. `u`: uniform in [0, 1). Not inlined, to bound the stack of kernels.
RELUME_HD_NOINLINE inline void add_to_record(const SurfacePoint& sp, const Vec3& wi, const Rgb& arriving, float u,
                                             FirstVertex& vertex) {
  const float added = luminance(eval_pdf(sp, wi).f * arriving);
  if (!(added > 0.0f) || !is_finite(added)) return;
  const float known = is_black(vertex.indirect) ? 0.0f : luminance(eval_pdf(sp, vertex.scatter).f * vertex.indirect);
  const bool is_first = !(known > 0.0f) || !is_finite(known);
  const float sum = is_first ? added : known + added;
  if (is_first || u * sum < added) {
    vertex.scatter = wi;
    vertex.indirect = arriving * (sum / added);
  } else {
    vertex.indirect *= sum / known;
  }
}

struct IndirectImage {
  ReuseImage planes;
  View<FirstVertex> first_vertices = {};  ///< records of paths, without the light that is added here; may be empty

  /// Adds the light of a vertex. `weight`: per area. `u`: uniform in [0, 1), for the choice of add_to_record().
  RELUME_HD void add(const SceneView& scene, const Receiver& r, const Reconnection& c, const Rgb& light, float weight,
                     uint32_t pixel, float u) const {
    const Rgb value = r.path.throughput * reflected_from(scene, r, c, light) * weight;
    planes.radiance[pixel] += value;
    if (!planes.specular.empty()) planes.specular[pixel] += value * specular_share(r.sp, c.wi);
    if (!first_vertices.empty())
      add_to_record(r.sp, c.wi, arriving(scene, r, c, light) * weight, u, first_vertices[pixel]);
  }

 private:
  /// Radiance · cosine of a vertex, per area. The wavelength weight is not part of the BSDF, so this includes it.
  RELUME_HD static Rgb arriving(const SceneView& scene, const Receiver& r, const Reconnection& c, const Rgb& light) {
    const Rgb value = light * (shading_cosine(r.sp, c.wi) * c.geometry());
    const bool dispersed = scene.disperses && (r.path.dispersed || disperses(scene, r.sp, c.wi));
    return dispersed ? value * wavelength_weight(r.path.wavelength_nm) : value;
  }
};

}  // namespace relume
