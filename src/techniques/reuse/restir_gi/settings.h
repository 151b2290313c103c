// Settings of ReSTIR GI.
#pragma once

#include "techniques/reuse/reservoir/settings.h"

namespace relume {

struct RestirGiSettings {
  ReuseCorrection correction = ReuseCorrection::exact;
  ReuseFeedback feedback = ReuseFeedback::spatial;
  int cap = 20;               ///< confidence of a history, in frames; 0: no temporal reuse
  int neighbours = 3;         ///< 0: no spatial reuse
  float radius = 30;          ///< of the neighbours, pixels
  float roughness = 0.25f;    ///< minimum roughness of receivers, as in glTF
  bool reuse_glossy = false;  ///< whether vertices of this roughness count as Lambertian
  float jacobian = 10;        ///< maximum Jacobian of a reused sample
  int validate = 3;           ///< frames between repetitions of a sample's path; 0: none
};

SettingList describe(RestirGiSettings& settings);

}  // namespace relume
