// What all steps of bidirectional path tracing share.
#pragma once

#include "core/fixed_point.h"
#include "techniques/transport/bdpt/path_vertex.h"
#include "techniques/transport/path/path.h"

namespace relume {

struct BdptContext {
  PathContext path;
  PowerLights emission;          ///< chooses the lights that subpaths start from
  PowerLights connection;        ///< what weights take for how connections choose lights; see weighting_pmf()
  View<const Rgb> light_medium;  ///< LightMediumKernel's; empty: no light stands in a tinted body
  View<FixedPointRgb> splats;
  uint32_t width = 0;
  uint32_t max_light_vertices = 16;  ///< at most kMaxLightVertices
  float connection_roulette = 0;     ///< 0: every connection is tested; see ConnectionRoulette
  bool light_only = false;           ///< light tracing: light subpaths alone, connected to the camera

  RELUME_HD const SceneView& scene() const { return path.scene; }

  /// Longest path that is sampled from both sides, vertices on light and camera included.
  RELUME_HD uint32_t max_bidirectional_vertices() const {
    const uint32_t longest = path.max_bounces + 2;
    // With one bounce a light subpath costs two rays of five for one strategy of three, and the other two find its
    // paths at least as well for the time.
    if (path.max_bounces == 1 && connection_roulette > 0.0f && !light_only) return 2;
    return light_only ? longest : (longest < max_light_vertices + 1 ? longest : max_light_vertices + 1);
  }
};

/// Probability of choosing `light` for a connection, as the weights take it. It may not depend on where the connection
/// starts, since light subpaths cannot know how a selector would see that vertex from the camera's side; selectors that
/// do depend on it are weighted as if they followed the power.
RELUME_HD inline float weighting_pmf(const BdptContext& c, LightId light) {
  const LightSelector& selector = c.path.selector;
  return selector.kind == LightSelectorKind::uniform ? selector.uniform.pmf(light) : c.connection.pmf(light);
}

/// Pairs of random numbers of light subpaths, far behind those of the longest camera path: position and direction on
/// the light, then direction and point on the lens at each vertex.
inline constexpr uint32_t kLightDimensions = 4096;
inline constexpr uint32_t kLightDimensionsPerVertex = 2;

/// What one sample of one pixel counts.
struct BdptCounters {
  uint32_t rays = 0;
  uint32_t saturated = 0;  ///< splats that were cut to kFixedPointMax
  uint32_t nonfinite = 0;  ///< splats that could not be added
};

/// Adds light to the pixel at film position `film`.
RELUME_HD inline void splat(const BdptContext& c, const Vec2& film, const Rgb& value, BdptCounters& counters) {
  if (!is_finite(value)) {
    ++counters.nonfinite;
    return;
  }
  if (max_component(value) > kFixedPointMax) ++counters.saturated;
  c.splats[static_cast<uint32_t>(film.y) * c.width + static_cast<uint32_t>(film.x)].add(value);
}

/// Decides which connections of a sample are tested. Those that carry little beside what it has tried so far are tested
/// with less than certainty and count for more.
struct ConnectionRoulette {
  float tested = 0;  ///< luminance of the connections tried so far

  /// True if the connection is to be tested, with what it then contributes.
  RELUME_HD bool survives(const BdptContext& c, uint32_t ray_id, Rgb& contribution) {
    if (!(c.connection_roulette > 0.0f)) return true;
    const float carried = luminance(contribution);
    const float scale = c.connection_roulette * tested;
    tested += carried;
    if (!(carried < scale)) return true;
    constexpr uint32_t kSalt = 0xffffffffu;  // no vertex has this index
    if (to_unit_float(hash(ray_id, kSalt)) * scale >= carried) return false;
    contribution *= scale / carried;
    return true;
  }
};

/// A sampled path segment; true if nothing is in between. Counts the ray.
RELUME_HD inline bool visible(const BdptContext& c, const Ray& ray, uint32_t ray_id, BdptCounters& counters) {
  ++counters.rays;
  return !occluded(c.scene().accel, ray, ray_id);
}

}  // namespace relume
