// Pixels of frames, wherever they are.
#pragma once

#include <cstddef>
#include <vector>

#include "viewer/render/request.h"

namespace relume::viewer {

/// Radiance of a pixel, counted by rows. Waits for a GPU if it has the image; 0 if that has failed.
Rgb radiance_at(const ViewerFrame& frame, size_t pixel);

/// Radiance of all pixels, in the same way; empty if a GPU has failed.
std::vector<Rgb> radiance_of(const ViewerFrame& frame);

}  // namespace relume::viewer
