// Data shared by all steps of bidirectional path tracing.
#pragma once

#include "core/fixed_point.h"
#include "core/hash.h"
#include "techniques/guiding/markov_chain/guide_recorder.h"
#include "techniques/light_sampling/markov_chain_lights/light_chain_recorder.h"
#include "techniques/spatial/octree/path_recording.h"
#include "techniques/transport/bdpt/first_light.h"
#include "techniques/transport/bdpt/path_vertex.h"
#include "techniques/transport/path/first_scatter.h"
#include "techniques/transport/path/path.h"

namespace relume {

/// New states of Markov chains from camera subpaths. Those of chains that are not chosen have no vertices.
struct SubpathChains {
  GuideRecording guide;
  LightChainRecording lights;

  /// Clears the records of a pixel.
  RELUME_HD void skip(uint32_t pixel) const {
    guide.out.skip(pixel);
    lights.out.skip(pixel);
  }
};

struct BdptContext {
  /// Whether learned structures guide the paths. If not, the code for them compiles away.
  static constexpr bool kLearns = false;

  PathContext path;
  PowerLights emission;          ///< distribution of the lights where subpaths start
  PowerLights connection;        ///< distribution that weights assume for connections; see weighting_pmf()
  View<const Rgb> light_medium;  ///< output of LightMediumKernel; empty: no light is inside a tinted medium
  View<FixedPointRgb> splats;
  FirstLight first_light;  ///< empty: no history verifies pixels
  uint32_t width = 0;
  uint32_t max_light_vertices = 16;     ///< at most kMaxLightVertices
  float connection_roulette = 0;        ///< strength of ConnectionRoulette; 0: tests every connection
  bool light_only = false;              ///< true for light tracing: light subpaths alone, connected to the camera
  float light_paths = 1;                ///< light subpaths per pixel, as assumed by the weights
  float merging = 0;                    ///< η² of vertex merging (partial_weights.h); 0: none
  float connected = 1;                  ///< square of the number of connections between surfaces, as light_paths
  float wavelength_nm = kNoWavelength;  ///< of all paths of the frame; kNoWavelength: every sample has its own
  View<FixedPointRgb> splat_differences = {};  ///< `splats` with the signs of has_negative_sign(); may be empty
  View<FirstScatter> first_scatters = {};      ///< of camera subpaths, for reservoirs; empty: none are recorded

  // Of LearningContext, which has no members of its own, as kernels have standard layout.
  PathRecording recording = {};
  SubpathChains chains = {};
  /// Whether weights use the density of directions that quadtrees guide. Otherwise they use that of the BSDF, as
  /// without guiding, and always with Markov chains. Either way they sum to one, but only those of the BSDF are the
  /// same in all frames.
  bool weighs_guide = true;

  RELUME_HD const SceneView& scene() const { return path.scene; }

  /// Clears the records of a pixel for later passes, before its subpaths are traced.
  RELUME_HD void begin_records(uint32_t pixel) const {
    first_light.begin(pixel);
    if (!first_scatters.empty()) first_scatters[pixel] = {};
  }

  /// Number of vertices of the longest path sampled from both sides, including those on light and camera.
  RELUME_HD uint32_t max_bidirectional_vertices() const {
    const uint32_t longest = path.max_bounces + 2;
    // With one bounce, a light subpath costs two of five rays for one of three strategies. The other two are at least
    // as efficient for its paths.
    if (path.max_bounces == 1 && connection_roulette > 0.0f && !light_only) return 2;
    return light_only ? longest : (longest < max_light_vertices + 1 ? longest : max_light_vertices + 1);
  }

  /// Maximum number of vertices kept of a light subpath: not that on the light, and not the last of the longest path.
  RELUME_HD uint32_t max_kept_vertices() const {
    const uint32_t longest = max_bidirectional_vertices();
    return light_only || longest < 2 ? 0 : longest - 2;
  }
};

/// Context of paths that take lights or directions from learned structures, and record samples or states for them
/// (light selections "vlc", "neeat" and "mcls", guiding "cdq" and "mcpg").
struct LearningContext : BdptContext {
  static constexpr bool kLearns = true;
};

/// Looks up the region of a vertex of a light subpath, where densities depend on it.
template <typename Context>
RELUME_HD inline void find_region(const Context& c, SurfacePoint& sp) {
  if constexpr (Context::kLearns) {
    const DirectionSampler& directions = c.path.directions;
    const bool weighs = c.weighs_guide && directions.kind != DirectionSamplerKind::bsdf;
    if (weighs || !directions.importance.empty()) sp.region = c.recording.lookup.region_at(sp);
  }
}

/// How subpaths choose directions at a point, as assumed by the weights.
template <typename Context>
RELUME_HD inline GuidedPoint guided_point(const Context& c, const SurfacePoint& sp) {
  if constexpr (Context::kLearns) {
    if (c.weighs_guide) return c.path.directions.guided(sp);
  }
  return {};
}

/// Density with which camera subpaths continue along `wi`, as assumed by the weights. `pdf_bsdf`: that of the BSDF.
template <typename Context>
RELUME_HD inline float camera_pdf(const Context& c, const GuidedPoint& point, const Vec3& wi, float pdf_bsdf) {
  if constexpr (Context::kLearns) {
    return c.path.directions.pdf(point, wi, pdf_bsdf);
  } else {
    return pdf_bsdf;
  }
}

/// The same for light subpaths.
template <typename Context>
RELUME_HD inline float light_pdf(const Context& c, const GuidedPoint& point, const Vec3& wi, float pdf_bsdf) {
  if constexpr (Context::kLearns) {
    return c.path.directions.importance_pdf(point, wi, pdf_bsdf);
  } else {
    return pdf_bsdf;
  }
}

/// Probability with which light subpaths sample the BSDF at a point, as assumed by the weights. That of camera subpaths
/// is GuidedPoint::fraction.
template <typename Context>
RELUME_HD inline float light_fraction(const Context& c, const GuidedPoint& point) {
  if constexpr (Context::kLearns) {
    return c.path.directions.importance_fraction(point);
  } else {
    return 1.0f;
  }
}

/// Density of a direction that a subpath has sampled, as assumed by the weights.
template <typename Context>
RELUME_HD inline float sampled_pdf(const Context& c, const BsdfSample& s) {
  if constexpr (Context::kLearns) {
    if (!c.weighs_guide && s.bsdf_pdf_w > 0.0f) return s.bsdf_pdf_w;
  }
  return s.pdf_w;
}

/// Changes the densities of a scattering from `wo` to `w` at a vertex of a light subpath to those of guided subpaths.
template <typename Context>
RELUME_HD inline void include_guiding(const Context& c, const GuidedPoint& guide, const Vec3& w, const Vec3& wo,
                                      AdjointEval& e) {
  e.pdf_light = light_pdf(c, guide, w, e.pdf_light);
  e.pdf_camera = camera_pdf(c, guide, wo, e.pdf_camera);
}

/// Scattering at a vertex of a light subpath towards `w`, the camera's side.
template <typename Context>
RELUME_HD inline AdjointEval eval_light_vertex(const Context& c, const SurfacePoint& sp, const Vec3& w) {
  AdjointEval e = eval_adjoint(sp, w);
  if constexpr (Context::kLearns) include_guiding(c, guided_point(c, sp), w, sp.wo, e);
  return e;
}

/// The same for a stored vertex and its guided_point(). `time`: of the path, within the shutter.
template <typename Context>
RELUME_HD inline AdjointEval eval_light_vertex(const Context& c, const PathVertex& v, const GuidedPoint& guide,
                                               const Vec3& w, float wavelength_nm, float time) {
  AdjointEval e = eval_vertex(c.scene(), v, w, wavelength_nm, time);
  if constexpr (Context::kLearns) include_guiding(c, guide, w, v.wo, e);
  return e;
}

/// Vertices of a light subpath without the one on the light, kept for connections.
struct KeptVertices {
  View<const PathVertex> vertices = {};
  View<const GuidedPoint> guides = {};  ///< guided_point() of each; empty: not guided
};

template <typename Context>
RELUME_HD inline GuidedPoint kept_guide(const Context&, const View<const GuidedPoint>& guides, uint32_t vertex) {
  if constexpr (Context::kLearns) {
    if (!guides.empty()) return guides[vertex];
  }
  return {};
}

/// Probability of choosing `light` for a connection, as used by the weights. It must not depend on the start of the
/// connection: light subpaths cannot evaluate a selector from the camera's side. Selectors that do depend on it,
/// learned or not, are weighted as if they followed the power.
RELUME_HD inline float weighting_pmf(const BdptContext& c, LightId light) {
  const LightSelector& selector = c.path.selector;
  return selector.kind == LightSelectorKind::uniform ? selector.uniform.pmf(light) : c.connection.pmf(light);
}

/// Wavelength of a subpath, nanometres.
RELUME_HD inline float subpath_wavelength(const BdptContext& c, const Sampler& sampler) {
  return c.wavelength_nm != kNoWavelength ? c.wavelength_nm : path_wavelength(c.scene(), sampler);
}

/// First dimension of light subpaths (pairs of random numbers), beyond those of the longest camera path. Order:
/// position and direction on the light, then direction and lens position at each vertex.
inline constexpr uint32_t kLightDimensions = 4096;
inline constexpr uint32_t kLightDimensionsPerVertex = 2;

/// Whether a light subpath counts negatively in differences between halves of the subpaths. `number`: of the subpath.
RELUME_HD inline bool has_negative_sign(uint32_t number) { return (hash(number) & 1u) != 0; }

/// Counters of one sample of one pixel.
struct BdptCounters {
  uint32_t rays = 0;
  uint32_t saturated = 0;  ///< splats clamped to kFixedPointMax
  uint32_t nonfinite = 0;  ///< splats left out as not finite
  bool subtracts = false;  ///< has_negative_sign() of the light subpath
};

/// Adds radiance to the pixel at raster position `raster`. `direction`: octahedral, from the first surface seen by the
/// camera along the light subpath. `id`: unique in the frame.
RELUME_HD inline void splat(const BdptContext& c, const Vec2& raster, const Rgb& value, uint32_t direction, uint32_t id,
                            BdptCounters& counters) {
  if (!is_finite(value)) {
    ++counters.nonfinite;
    return;
  }
  if (max_component(value) > kFixedPointMax) ++counters.saturated;
  const uint32_t pixel = static_cast<uint32_t>(raster.y) * c.width + static_cast<uint32_t>(raster.x);
  c.splats[pixel].add(value);
  if (!c.splat_differences.empty()) c.splat_differences[pixel].add(counters.subtracts ? -value : value);
  c.first_light.offer_splat(pixel, direction, value, id);
}

/// Selects the connections of a sample whose visibility is tested. Connections that are small relative to those tried
/// so far are tested with a probability below 1 and scaled by its inverse.
struct ConnectionRoulette {
  float tested = 0;  ///< luminance of the connections tried so far

  /// Counts a connection that is tested in any case.
  RELUME_HD void count(const Rgb& contribution) { tested += luminance(contribution); }

  /// Returns whether to test the connection, and scales its contribution by the inverse probability. `unit`: factor by
  /// which contributions count in the image.
  RELUME_HD bool survives(const BdptContext& c, uint32_t ray_id, Rgb& contribution, const Rgb& unit = Rgb(1)) {
    if (!(c.connection_roulette > 0.0f)) return true;
    const float carried = luminance(contribution * unit);
    const float scale = c.connection_roulette * tested;
    tested += carried;
    if (!(carried < scale)) return true;
    constexpr uint32_t kSalt = 0xffffffffu;  // no vertex has this index
    if (to_unit_float(hash(ray_id, kSalt)) * scale >= carried) return false;
    contribution *= scale / carried;
    return true;
  }
};

/// Tests a path segment and counts the ray. Returns true if it is not blocked.
RELUME_HD inline bool visible(const BdptContext& c, const Ray& ray, uint32_t ray_id, BdptCounters& counters) {
  ++counters.rays;
  return !occluded(c.scene(), ray, ray_id);
}

}  // namespace relume
