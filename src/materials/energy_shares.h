// What the tables of microfacet albedos hold.
#pragma once

namespace relume {

/// Single-scattering albedo under Schlick's Fresnel, split as f0·(total − grazing) + f90·grazing.
struct EnergyShares {
  float total = 1;    ///< albedo for F = 1
  float grazing = 0;  ///< the part that (1 − cos)^5 weighs
};

}  // namespace relume
