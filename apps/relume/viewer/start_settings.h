// The settings that the viewer opens with.
#pragma once

#include "render/settings.h"

namespace relume::viewer {

/// As resolve(); where neither flags, preset, file nor scene say anything of techniques, with those of the preset
/// "interactive". Throws Error.
Settings resolve_start(SettingSources sources);

}  // namespace relume::viewer
