#include "techniques/light_sampling/light_selection/settings.h"

namespace relume {

SettingList describe(LightSelectionSettings& s) {
  return {
      {"environment", &s.environment,
       "Next event estimation samples the environment and the disks of suns; without, paths find them on their own"}};
}

}  // namespace relume
