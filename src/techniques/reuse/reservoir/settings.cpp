#include "techniques/reuse/reservoir/settings.h"

namespace relume {

SettingList describe(RisSettings& s) {
  return {{"candidates",
           &s.candidates,
           "Lights sampled per pixel and frame, of which one gets a shadow ray (reuse ris, restir-di)",
           {.min = 1, .max = 256}}};
}

}  // namespace relume
