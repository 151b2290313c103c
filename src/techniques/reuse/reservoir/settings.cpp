#include "techniques/reuse/reservoir/settings.h"

namespace relume {

SettingList describe(RisSettings& s) {
  return {{"candidates",
           &s.candidates,
           "Number of lights sampled per pixel and frame with reuse ris or restir-di, of which one gets a shadow ray",
           {.min = 1, .max = 256}}};
}

}  // namespace relume
