// Camera subpaths: their state, and the lights that they meet (s = 0).
#pragma once

#include "techniques/transport/bdpt/subpath_recorder.h"

namespace relume {

/// Units of a camera subpath, as a policy reports them.
struct SubpathUnits : NoPolicy {
  Rgb unit{1};    ///< factor by which radiance and throughput of the path count in the image
  Rgb before{0};  ///< radiance in the image that the path found before the last change of `unit`

  RELUME_HD void rebased(const Rgb& found, const Rgb& next_unit) {
    before += unit * found;
    unit = next_unit;
  }
};

struct CameraSubpath {
  PathState path;
  SubpathWeights weights;
  SubpathUnits units;
  uint32_t pixel = 0;
  Vec3 first_direction{0};  ///< sampled at the first surface; zero: none, or from a delta lobe
  Rgb found_before{0};      ///< radiance in the image that was found before that direction

  /// Number of vertices so far, including that on the camera and the current surface point.
  RELUME_HD uint32_t count() const { return path.bounce + 2; }
};

RELUME_HD inline void start_camera_subpath(const BdptContext& c, uint32_t x, uint32_t y, Sampler& sampler,
                                           CameraSubpath& e) {
  e.pixel = y * c.width + x;
  e.path.ray = camera_ray(c.scene().camera, x, y, sampler);
  const CameraView camera = camera_at(c.scene().camera, e.path.ray.time);
  e.path.cone_width = camera.cone_width();
  e.path.cone_spread = camera.cone_spread();
  e.path.medium = c.scene().camera_medium;
  e.path.wavelength_nm = subpath_wavelength(c, sampler);
  const CameraPdf pdf = pdf_of_generated(camera, e.path.ray);
  const bool parallel = camera.projection == Projection::orthographic;
  const bool can_be_hit = camera.projection == Projection::perspective && camera.lens_radius > 0.0f;
  const float cosine = can_be_hit ? -glm::dot(e.path.ray.direction, camera.axes.n) : 1.0f;
  e.weights = SubpathWeights::start(parallel ? pdf.pdf_a : pdf.pdf_w, can_be_hit ? c.light_paths / pdf.pdf_a : 0.0f,
                                    cosine, c.light_paths, parallel, c.merging, c.connected);
}

/// Densities with which light sampling finds a point on a light, per area (at infinity: per solid angle).
struct LightDensities {
  float connected;  ///< by a connection
  float emitted;    ///< as the first vertex of a light subpath
};

RELUME_HD inline LightDensities light_densities(const BdptContext& c, LightId id, float pdf) {
  return {weighting_pmf(c, id) * pdf, c.emission.pmf(id) * pdf};
}

/// Weight of meeting a light at the last vertex of the subpath. `onwards`: density of emission from the light to the
/// previous vertex, as for SubpathWeights. `recorder`, here and below: gets the terms of the weight.
template <typename Recorder = NoRecorder>
RELUME_HD inline float weight_of_light_hit(const BdptContext& c, const CameraSubpath& e, const PartialWeights& at,
                                           const LightDensities& densities, float onwards,
                                           Recorder&& recorder = Recorder{}) {
  const bool from_both_sides = e.count() <= c.max_bidirectional_vertices();
  float denominator = at.last(densities.connected) / c.connected;  // one connection to the light
  if (from_both_sides) denominator += sqr(densities.emitted * onwards) * at.b;
  recorder.weigh(
      {1.0f, sqr(densities.connected) / c.connected, from_both_sides ? sqr(densities.emitted * onwards) : 0.0f});
  return weight_from(denominator, 0.0f);
}

/// s = 0: adds the emission of the last vertex. Only this strategy finds emitters in direct view.
template <typename Recorder>
RELUME_HD inline void add_met_emission(const BdptContext& c, const SurfacePoint& sp, CameraSubpath& e,
                                       Recorder& recorder) {
  if (is_black(sp.emission)) return;
  if (sp.light != kNoLight && c.path.left_to_reservoirs(e.path, sp.light)) return;
  float weight = 1.0f;
  recorder.weigh({});
  if (e.path.bounce > 0 && sp.light != kNoLight) {
    const EmissionPdf pdf = pdf_le(c.scene().lights, sp.light, sp.emitter_point(), sp.wo);
    weight = weight_of_light_hit(c, e, e.weights.at(), light_densities(c, sp.light, pdf.pdf_a), pdf.pdf_w, recorder);
  }
  const Rgb met = e.path.throughput * sp.emission * weight;
  e.path.radiance += met;
  recorder.add_met(met, e.weights.at(), e.path, !e.path.delta && sp.light != kNoLight);
}

/// s = 0: adds light from infinity along a ray that left the scene.
template <typename Recorder>
RELUME_HD inline void add_met_infinite_lights(const BdptContext& c, CameraSubpath& e, Recorder& recorder) {
  const LightsView& lights = c.scene().lights;
  const Vec3& wi = e.path.ray.direction;
  const PartialWeights at = e.weights.arrive(1.0f, 1.0f);
  recorder.moved(1.0f, 1.0f);
  for (LightId id = lights.first_infinite; id < lights.lights.size; ++id) {
    const Rgb radiance = radiance_from_infinity(lights, id, wi);
    if (is_black(radiance) || c.path.left_to_reservoirs(e.path, id)) continue;
    float weight = 1.0f;
    LightDensities densities{0, 0};
    if (e.path.bounce > 0) {
      const EmissionPdf pdf = pdf_le(lights, id, {}, -wi);
      densities = light_densities(c, id, pdf.pdf_w);
      weight = weight_of_light_hit(c, e, at, densities, pdf.pdf_a, recorder);
    }
    const Rgb met = e.path.throughput * radiance * weight;
    e.path.radiance += met;
    recorder.add_met(met, at, e.path, !e.path.delta && densities.connected > 0.0f);
  }
}

}  // namespace relume
