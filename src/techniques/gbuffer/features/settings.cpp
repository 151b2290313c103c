#include "techniques/gbuffer/features/settings.h"

namespace relume {

SettingList describe(FeatureSettings& s) {
  return {{"edge-rays",
           &s.edge_rays,
           "Camera rays per pixel at the edges of lamps and the sky, which denoisers do not filter; 0: only the "
           "sample's own ray",
           {.min = 0, .max = 256}},
          {"split",
           &s.split,
           "Denoise diffuse and specular light separately, each along its own motion; needs --estimator path and "
           "--cache none",
           {.biases = true}}};
}

}  // namespace relume
