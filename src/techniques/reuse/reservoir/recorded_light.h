// Records of first vertices that get light of reservoirs beside other light.
#pragma once

#include "scene/surface_point.h"

namespace relume {

/// Adds light from another direction to the record of a first vertex. The record stores one direction: each of the two
/// with a probability proportional to the luminance of the light that it reflects. Its light is scaled to the luminance
/// of both, so the mean over many records is the sum for both directions. `arriving`: as FirstVertex::indirect, along
/// `wi`. `u`: uniform in [0, 1). `direction`, `light`: those of the record. Not inlined, to bound the stack of kernels.
RELUME_HD_NOINLINE inline void add_to_record(const SurfacePoint& sp, const Vec3& wi, const Rgb& arriving, float u,
                                             Vec3& direction, Rgb& light) {
  const float added = luminance(eval_pdf(sp, wi).f * arriving);
  if (!(added > 0.0f) || !is_finite(added)) return;
  const float known = is_black(light) ? 0.0f : luminance(eval_pdf(sp, direction).f * light);
  const bool is_first = !(known > 0.0f) || !is_finite(known);
  const float sum = is_first ? added : known + added;
  if (is_first || u * sum < added) {
    direction = wi;
    light = arriving * (sum / added);
  } else {
    light *= sum / known;
  }
}

}  // namespace relume
