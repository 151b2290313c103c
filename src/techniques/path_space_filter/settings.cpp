#include "techniques/path_space_filter/settings.h"

#include <utility>

namespace relume {

SettingList describe(PathSpaceFilterSettings& s) {
  SettingList list = describe(s.grid);
  list.push_back({"min-roughness",
                  &s.min_roughness,
                  "Surfaces that reflect mostly off smoother layers than this are not filtered; the filter waits for "
                  "the next vertex",
                  {.min = 0, .max = 1, .biases = true}});
  return list;
}

}  // namespace relume
