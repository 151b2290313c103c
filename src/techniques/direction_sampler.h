// The slot "direction sampling": where a path goes on from a vertex. Guiding strategies mix with the BSDF inside, so
// pdf() is always the density of the whole mixture.
#pragma once

#include "sampling/sampler.h"
#include "scene/surface_point.h"

namespace relume {

enum class DirectionSamplerKind : int { bsdf };

struct DirectionSampler {
  DirectionSamplerKind kind = DirectionSamplerKind::bsdf;

  RELUME_HD BsdfSample sample(const SurfacePoint& sp, Sampler& sampler,
                              TransportMode mode = TransportMode::radiance) const {
    const float u_lobe =
        sp.bsdf.lobe_count > 1 || sp.bsdf.lobes[0].kind >= LobeKind::dielectric ? sampler.next_1d() : 0.0f;
    return relume::sample(sp, u_lobe, sampler.next_2d(), mode);
  }

  /// Density of sample() in direction `wi`, given the BSDF's value there.
  RELUME_HD float pdf([[maybe_unused]] const SurfacePoint& sp, [[maybe_unused]] const Vec3& wi,
                      const BsdfEval& bsdf) const {
    return bsdf.pdf_forward;
  }
};

}  // namespace relume
