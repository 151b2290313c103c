#include "techniques/transport/bdpt/settings.h"

#include "techniques/transport/bdpt/path_vertex.h"

namespace relume {

SettingList describe(BdptSettings& s) {
  return {
      {"max-light-vertices",
       &s.max_light_vertices,
       "Vertices of a light subpath, the one on the light included; paths of more vertices are found from the camera "
       "alone",
       {.min = 1, .max = kMaxLightVertices}},
      {"connection-roulette",
       &s.connection_roulette,
       "Connections that carry less than this share of what the sample has tried to connect so far are tested at "
       "random, and survivors count for more, and with one bounce there are no light subpaths; 0 tests all",
       {.min = 0, .max = 1}},
  };
}

}  // namespace relume
