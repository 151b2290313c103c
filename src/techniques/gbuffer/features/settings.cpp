#include "techniques/gbuffer/features/settings.h"

namespace relume {

SettingList describe(FeatureSettings& s) {
  return {
      {"edge-rays",
       &s.edge_rays,
       "Camera rays for pixels where a lamp or the sky ends, which no denoiser filters; 0: the sample's alone",
       {.min = 0, .max = 256}},
      {"split",
       &s.split,
       "Keep diffuse and specular light apart, so that reflections move as reflections do; needs estimator path and "
       "no radiance cache",
       {.biases = true}}};
}

}  // namespace relume
