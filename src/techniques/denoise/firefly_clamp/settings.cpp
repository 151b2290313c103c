#include "techniques/denoise/firefly_clamp/settings.h"

namespace relume {

SettingList describe(FireflySettings& s) {
  return {{"limit",
           &s.limit,
           "Scale samples down to this multiple of their neighbours' mean luminance, before history and denoising; 0: "
           "off; the light above it is lost",
           {.min = 0, .max = 1e6, .biases = true}}};
}

}  // namespace relume
