#include "techniques/temporal/upscaling/settings.h"

namespace relume {

SettingList describe(UpscalingSettings& s) {
  return {{"upscale",
           &s.factor,
           "Temporal upscaling: edge of blocks of pixels, each of which traces one path per frame, at another of its "
           "pixels each time. Denoisers still read surfaces at every pixel. 1: a path in every pixel",
           {.min = 1, .max = kMostUpscale}}};
}

}  // namespace relume
