// The flag --ocio of `relume render` and `relume view`.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "framebuffer/ocio_view.h"

namespace relume::cli {

/// The configuration file in "CONFIG:VIEW".
std::string ocio_config(const std::string& option);

/// The view named by "CONFIG:VIEW"; nullptr for an empty text. Overrides tone maps of files and presets. Throws
/// UsageError if the text has another form or `flags` choose a tone map, and Error if the view cannot be used.
std::shared_ptr<const OcioView> make_ocio_view(const std::string& option,
                                               const std::vector<std::pair<std::string, std::string>>& flags);

}  // namespace relume::cli
