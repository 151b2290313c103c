// Settings for tests of sums of samples.
#pragma once

#include "render/render_settings.h"

namespace relume::testing {

/// A small image on one thread, whose session keeps sums of samples.
inline RenderSettings summing_settings() {
  RenderSettings settings;
  settings.width = 16;
  settings.height = 12;
  settings.threads = 1;
  settings.samples.sums = true;
  return settings;
}

}  // namespace relume::testing
