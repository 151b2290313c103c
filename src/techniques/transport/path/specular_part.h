// Part of a sample's radiance scattered towards the camera by specular lobes of the first vertex. Histories store it
// separately, because reflections move differently from their surface.
#pragma once

#include "techniques/transport/path/path_kernel.h"

namespace relume {

/// Share of the specular lobes in the value of the BSDF along `wi`.
RELUME_HD inline Rgb specular_share(const SurfacePoint& sp, const Vec3& wi) {
  const SpecularLobes lobes = specular_lobes(sp.bsdf);
  if (lobes != SpecularLobes::some) return Rgb(lobes == SpecularLobes::all ? 1.0f : 0.0f);
  const Vec3 wi_local = sp.frame.to_local(wi);
  const Rgb all = eval_pdf(sp.bsdf, sp.wo_local, wi_local).f;
  const Rgb specular = eval_specular(sp.bsdf, sp.wo_local, wi_local);
  Rgb share(0);
  for (int c = 0; c < 3; ++c) share[c] = all[c] > 0.0f ? relume::min(specular[c] / all[c], 1.0f) : 0.0f;
  return share;
}

/// Splits next event estimation and the BSDF sample of the first vertex by the lobes' shares in the BSDF, so each part
/// is unbiased. Emission towards the camera belongs to neither part.
struct SpecularPolicy : NoPolicy {
  Rgb specular{0};
  Rgb share{0};  ///< share of the light along the sampled direction
  Rgb radiance_before{0};

  RELUME_HD void connected(const SurfacePoint& sp, const PathState& path, const Connection& c, bool visible) {
    if (visible && path.bounce == 0) specular += c.contribution * specular_share(sp, c.ray.direction);
  }
  RELUME_HD void scattered(const SurfacePoint& sp, const BsdfSample& s, const PathState& after) {
    if (after.bounce != 1) return;
    share = s.delta ? Rgb(1) : specular_share(sp, s.wi);
    radiance_before = after.radiance;
  }
  RELUME_HD void finished(const PathState& path) { specular += (path.radiance - radiance_before) * share; }
};

/// Output of the specular part of each path's radiance.
struct SpecularOutput {
  using Policy = SpecularPolicy;

  View<Rgb> specular;  ///< of this sample; may be non-finite

  RELUME_HD SpecularPolicy policy(const SampleIndex&, uint32_t, uint32_t, uint32_t) const { return {}; }
  RELUME_HD void finish(uint32_t pixel, const SpecularPolicy& policy, const PathState&) const {
    specular[pixel] = policy.specular;
  }
  RELUME_HD void leave_out(uint32_t pixel) const { specular[pixel] = Rgb(0); }
};

}  // namespace relume
