// Conversion of a frame to display colours on the processor.
#pragma once

#include <cstdint>
#include <span>

#include "viewer/render/display_transform.h"

namespace relume::viewer {

struct DisplayTable;

/// Writes the colours of `values` to `rgb`, three bytes each, as the window's shader does. `table`: that of the
/// transform or, without one, display_table() of its tone map. Values that are not finite become magenta.
void develop(std::span<const Rgb> values, const DisplayTransform& transform, const DisplayTable& table,
             std::span<uint8_t> rgb);

}  // namespace relume::viewer
