// Applies settings that are texts.
#pragma once

#include <string_view>

#include "render/render_settings.h"

namespace relume {

/// Applies settings in the syntax of `relume compare`: "cache:psf,psf.cell-size:0.05"; empty: none. Throws Error that
/// begins with `place`.
void apply_settings(std::string_view texts, std::string_view place, RenderSettings& settings);

}  // namespace relume
