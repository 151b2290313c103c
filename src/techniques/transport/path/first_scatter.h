// Record of the direction that a path takes at its primary hit, and of the light source that it meets there. Reservoirs
// (techniques/reuse) use it as a candidate, which costs no ray of its own.
#pragma once

#include "framebuffer/buffer_key.h"
#include "techniques/transport/path/path_kernel.h"

namespace relume {

struct FirstScatter {
  Vec3 direction{0};
  float pdf_w = 0;              ///< per steradian; 0: no direction, a delta lobe, or no light source
  LightId light = kNoLight;     ///< light source that the direction meets; kNoLight: it leaves the scene
  Vec2 barycentric{0};          ///< of the hit on that light's triangle
  uint32_t region = kNoRegion;  ///< region of the primary hit for light selection and guiding
  float resampling = 1;         ///< factor of light from that direction, as BsdfSample::resampling
};

/// First scattering event of the path of each pixel.
inline constexpr BufferKey<FirstScatter> kFirstScatters{"first-scatters"};

/// Records the first scattering event of a path. A policy that sets the region of vertices must precede it.
struct FirstScatterPolicy : NoPolicy {
  FirstScatter* scatter;  ///< empty at the start

  RELUME_HD bool arrived(const SurfacePoint& sp, const PathState& path) {
    if (path.bounce == 0) scatter->region = sp.region;
    return true;
  }
  RELUME_HD void scattered(const SurfacePoint&, const BsdfSample& s, const PathState& after) {
    if (after.bounce != 1 || s.delta) return;
    scatter->direction = s.wi;
    scatter->pdf_w = s.pdf_w;
    scatter->resampling = s.resampling;
  }
  RELUME_HD void hit_surface(const SurfacePoint& sp, const PathState& path) {
    if (path.bounce != 1) return;
    if (sp.light == kNoLight || is_black(sp.emission)) {
      scatter->pdf_w = 0;
      return;
    }
    scatter->light = sp.light;
    scatter->barycentric = sp.barycentric;
  }
};

/// Output of the first scattering event of each path.
struct FirstScatterOutput {
  using Policy = FirstScatterPolicy;

  View<FirstScatter> first_scatters;

  RELUME_HD FirstScatterPolicy policy(const SampleIndex&, uint32_t, uint32_t, uint32_t pixel) const {
    first_scatters[pixel] = {};
    FirstScatterPolicy policy;
    policy.scatter = &first_scatters[pixel];
    return policy;
  }
  RELUME_HD void finish(uint32_t, const FirstScatterPolicy&, const PathState&) const {}
  RELUME_HD void leave_out(uint32_t pixel) const { first_scatters[pixel] = {}; }
};

}  // namespace relume
