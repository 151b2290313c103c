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
       "Roulette: test a connection at random if its light is below this fraction of the sum over the sample's earlier "
       "connections. With one bounce, roulette also leaves out light subpaths. 0: test all",
       {.min = 0, .max = 1}},
      {"caustic-layer",
       &s.caustic_layer,
       "Denoise light paths connected to the camera, and merged light behind specular surfaces, separately from the "
       "rest of the image, also with --estimator light and vcm; adds the layer caustics",
       {.biases = true}},
  };
}

}  // namespace relume
