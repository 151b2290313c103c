#include "techniques/radiance_cache/path_space_filter/settings.h"

#include <utility>

namespace relume {

SettingList describe(PathSpaceFilterSettings& s) {
  SettingList list = describe(s.grid);
  list.push_back({"min-roughness",
                  &s.min_roughness,
                  "Surfaces that reflect mostly off smoother layers than this are not filtered; the filter waits for "
                  "the next vertex",
                  {.min = 0, .max = 1, .biases = true}});
  list.push_back({"edge-rays",
                  &s.edge_rays,
                  "Camera rays with which pixels at the edge of something bright find out how much of it they see; 0: "
                  "the path's own says it alone. With a denoiser features.edge-rays counts instead",
                  {.min = 0, .max = 256}});
  return list;
}

}  // namespace relume
