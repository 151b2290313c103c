// Settings of ReSTIR DI.
#pragma once

#include "techniques/reuse/reservoir/settings.h"

namespace relume {

struct RestirSettings {
  ReuseCorrection correction = ReuseCorrection::exact;
  ReuseFeedback feedback = ReuseFeedback::spatial;
  int cap = 20;        ///< confidence of a history, in frames; 0: no temporal reuse
  int neighbours = 3;  ///< 0: no spatial reuse
  float radius = 30;   ///< of the neighbours, pixels
};

SettingList describe(RestirSettings& settings);

}  // namespace relume
