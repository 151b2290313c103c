#include "techniques/transport/bdpt/settings.h"

#include "techniques/transport/bdpt/path_vertex.h"

namespace relume {

SettingList describe(BdptSettings& s) {
  return {
      {"max-light-vertices",
       &s.max_light_vertices,
       "Maximum number of vertices of a light subpath, including the one on the light; longer paths are sampled from "
       "the camera alone",
       {.min = 1, .max = kMaxLightVertices}},
      {"connection-roulette",
       &s.connection_roulette,
       "Test connections at random if they carry less than this fraction of the light that the sample has tried to "
       "connect so far. With one bounce, light subpaths are then left out. 0: test all",
       {.min = 0, .max = 1}},
  };
}

}  // namespace relume
