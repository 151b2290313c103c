// Rendering any samples of an image with one session, and exchanging their exact sums (framebuffer/pixel_sums.h). The
// session's settings must have SampleSettings::sums.
#pragma once

#include <cstdint>
#include <span>

#include "framebuffer/pixel_sums.h"
#include "relume/session.h"

namespace relume {

/// Discards the samples so far. The next frame has sample `first` of each pixel, as in a new session with this
/// SampleSettings::first, bit for bit. If samples adapt (samples_adapt()), the session begins a new replica.
void begin_samples(Session& session, uint32_t first);

/// The next frame has sample `next` of the image that the session has begun. Layers of its first frame are kept.
void skip_samples(Session& session, uint32_t next);

/// Adds the sums of the samples since the last call, or since begin_samples(), to `total` (one element per pixel), and
/// removes them from the session.
void take_samples(Session& session, std::span<PixelSums> total);

/// Makes these sums of `samples` samples per pixel the content of the session: its image, layers of means and
/// variances, and counts show them. The session must render no further frame.
void set_samples(Session& session, std::span<const PixelSums> sums, uint32_t samples);

}  // namespace relume
