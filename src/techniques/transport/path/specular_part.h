// The part of a sample's radiance that specular lobes of the first vertex scattered towards the camera. Histories keep
// it apart, because reflections move differently from the surface that shows them.
#pragma once

#include "techniques/transport/path/path_kernel.h"

namespace relume {

/// Share of the BSDF's value in direction `wi` that its specular lobes contribute.
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

/// Splits both estimates at the first vertex by the lobes' shares in the BSDF, so each part is unbiased. Radiance
/// emitted towards the camera is in neither.
struct SpecularObserver {
  Rgb specular{0};
  Rgb share{0};  ///< of the light that arrives along the sampled direction
  Rgb radiance_before{0};

  RELUME_HD void emitted(const PathState&, bool) {}
  RELUME_HD bool arrived(const SurfacePoint&, const PathState&) { return true; }
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

/// Keeps the specular part beside what `Observation` keeps.
template <typename Observation>
struct SpecularObservation {
  Observation observation;
  View<Rgb> specular;  ///< of this sample; may be not finite

  RELUME_HD auto observer(const SampleIndex& index, uint32_t x, uint32_t y, uint32_t pixel) const {
    return BothObservers<decltype(observation.observer(index, x, y, pixel)), SpecularObserver>{
        observation.observer(index, x, y, pixel), {}};
  }
  template <typename Observer>
  RELUME_HD void finish(uint32_t pixel, const Observer& observer, const PathState& path) const {
    observation.finish(pixel, observer.a, path);
    specular[pixel] = observer.b.specular;
  }
  RELUME_HD void leave_out(uint32_t pixel) const {
    observation.leave_out(pixel);
    specular[pixel] = Rgb(0);
  }
};

using SpecularPathKernel = ObservedPathKernel<SpecularObservation<RadianceObservation>>;

}  // namespace relume
