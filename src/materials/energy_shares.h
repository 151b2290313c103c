// Entries of the microfacet albedo tables.
#pragma once

namespace relume {

/// Single-scattering albedo under Schlick's Fresnel, split as f0·(total − grazing) + f90·grazing.
struct EnergyShares {
  float total = 1;    ///< albedo for F = 1
  float grazing = 0;  ///< part weighted by (1 − cos)^5
};

}  // namespace relume
