// Rendering the samples of an image in parts, which are summed exactly (framebuffer/pixel_sums.h).
#pragma once

#include <string>

#include "render/render_settings.h"

namespace relume {

/// Whether samples depend on those of earlier frames. Parts of such a render are independent replicas: each begins
/// without a history, with random numbers that depend on its first sample.
bool samples_adapt(const RenderSettings& settings);

/// Why the image of these settings is no mean of samples that can be summed in parts, with a remedy; empty if it is.
/// RenderSettings::auxiliary must be known.
std::string sums_refusal(const RenderSettings& settings);

}  // namespace relume
