#include "techniques/transport/vcm/settings.h"

namespace relume {

SettingList describe(VcmSettings& s) {
  return {
      {"radius",
       &s.radius,
       "Merging radius in the first frame, relative to the radius of the scene's bounding sphere. Larger values blur "
       "merged light. 0: no merging",
       {.min = 0, .max = 1, .biases = true}},
      {"alpha",
       &s.alpha,
       "Shrinks the merging radius while frames add up: in frame n since the last change, its square is that of the "
       "first times n^(alpha - 1). Below 1, the bias of merging vanishes; 1: constant radius",
       {.min = 0.1, .max = 1, .biases = true}},
      {"pixels-per-path", &s.pixels_per_path, "Number of pixels per light subpath", {.min = 1, .max = 1024}},
      {"connections",
       &s.connections,
       "Number of connections of a camera vertex to random light vertices of the frame. 0: to all vertices of one "
       "light subpath",
       {.min = 0, .max = 64}},
      {"memory",
       &s.memory_mib,
       "Limit of the memory for light vertices. Where they would exceed it, a frame traces fewer light subpaths",
       {.min = 1, .max = 65536, .unit = "MiB"}},
  };
}

}  // namespace relume
