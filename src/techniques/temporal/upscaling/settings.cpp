#include "techniques/temporal/upscaling/settings.h"

namespace relume {

SettingList describe(UpscalingSettings& s) {
  return {{"upscale",
           &s.factor,
           "Temporal upscaling: one path per frame in each block of this many by this many pixels, which take turns. "
           "Surfaces are sampled at every pixel. 1: a path in every pixel",
           {.min = 1, .max = kMostUpscale}}};
}

}  // namespace relume
