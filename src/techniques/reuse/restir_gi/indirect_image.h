// Outputs for the indirect light of reservoirs: planes of the image, and the records by which histories verify the
// light for another viewpoint.
#pragma once

#include "techniques/reuse/reservoir/recorded_light.h"
#include "techniques/reuse/reservoir/reuse_image.h"
#include "techniques/reuse/restir_gi/reconnection.h"
#include "techniques/transport/path/first_vertex.h"
#include "techniques/transport/path/specular_part.h"

namespace relume {

struct IndirectImage {
  ReuseImage planes;
  View<FirstVertex> first_vertices = {};  ///< records of paths, without the light that is added here; may be empty

  /// Adds the light of a vertex. `weight`: per area. `u`: uniform in [0, 1), for the choice of add_to_record().
  RELUME_HD void add(const SceneView& scene, const Receiver& r, const Reconnection& c, const Rgb& light, float weight,
                     uint32_t pixel, float u) const {
    const Rgb value = r.path.throughput * reflected_from(scene, r, c, light) * weight;
    planes.radiance[pixel] += value;
    if (!planes.specular.empty()) planes.specular[pixel] += value * specular_share(r.sp, c.wi);
    if (first_vertices.empty()) return;
    FirstVertex& vertex = first_vertices[pixel];
    add_to_record(r.sp, c.wi, arriving(scene, r, c, light) * weight, u, vertex.scatter, vertex.indirect);
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
