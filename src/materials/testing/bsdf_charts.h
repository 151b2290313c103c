// Charts of both hemispheres around the directions where a BSDF may peak.
#pragma once

#include "materials/testing/bsdf_cases.h"

namespace relume::testing {

/// Axes and width for DirectionChart, one above and one below the surface.
struct PeakDirections {
  Vec3 above;
  Vec3 below;
  double width;
};

inline PeakDirections peak_directions(const BsdfCase& c, const Vec3& wo) {
  PeakDirections p;
  p.above = Vec3(-wo.x, -wo.y, wo.z);
  if (!refract(wo, Vec3(0, 0, 1), c.eta, &p.below)) p.below = glm::normalize(Vec3(-wo.x, -wo.y, -0.05f));
  p.below = glm::normalize(p.below);
  p.width = clamp(c.alpha, 0.003f, 0.5f);
  return p;
}

}  // namespace relume::testing
