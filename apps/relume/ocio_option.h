// The flag --ocio, which `relume render` and `relume view` share.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "framebuffer/ocio_view.h"

namespace relume::cli {

/// The configuration file in "CONFIG:VIEW".
std::string ocio_config(const std::string& option);

/// The view that "CONFIG:VIEW" names; nullptr for an empty text. Throws UsageError if the text has another form or
/// `flags` choose a tone map, and Error if the view cannot be used. Tone maps of files and presets give way.
std::shared_ptr<const OcioView> make_ocio_view(const std::string& option,
                                               const std::vector<std::pair<std::string, std::string>>& flags);

}  // namespace relume::cli
