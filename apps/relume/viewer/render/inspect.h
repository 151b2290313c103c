// Displayable buffers of a session.
#pragma once

#include <string>
#include <vector>

#include "viewer/render/request.h"

namespace relume::viewer {

/// All buffers available for inspection with these settings, by name.
std::vector<AovLayer> inspectable_buffers(const RenderSettings& settings);

/// Whether the buffer requires recording auxiliary buffers, which costs time.
bool needs_auxiliary(const RenderSettings& settings, const std::string& buffer);

/// Copies the named buffer into the frame: channels, values and their range. If the session lacks it, the frame keeps
/// showing the image.
void read_buffer(const Session& session, const std::string& name, ViewerFrame& frame);

/// 1st and 99th percentile of the finite values of the first `channels` channels, from at most some thousand pixels.
/// Equal values are widened to an interval of length 1 that begins at 0 or ends at the value.
Vec2 value_range(const std::vector<Rgb>& values, size_t channels);

/// Describes the pixel at a point of the image, (0, 0) its top left corner and (1, 1) the opposite one. The text has
/// its radiance and the values, name and channels of the inspected buffer.
std::string describe_pixel(const ViewerFrame& frame, const Vec2& point);

}  // namespace relume::viewer
