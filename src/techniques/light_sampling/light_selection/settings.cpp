#include "techniques/light_sampling/light_selection/settings.h"

namespace relume {

SettingList describe(LightSelectionSettings& s) {
  return {{"environment", &s.environment,
           "Sample the environment and the disks of suns by next event estimation; off: only paths that happen to "
           "reach them add their light"}};
}

}  // namespace relume
