// Small parts that several panels share.
#pragma once

#include <string>

#include "core/vec.h"

namespace relume::viewer {

/// Explains the item before it while the mouse rests on it.
void tooltip(const std::string& text);

/// A heading with a line.
void heading(const char* text);

/// Colour and strength of something that shines: their product is edited. Returns whether it changed.
bool radiant_widget(const char* label, Rgb& value, const char* unit);

/// A number in [0, 1].
bool share_widget(const char* label, float& value, const char* help);

/// Degrees on the widget, radians in the value.
bool angle_widget(const char* label, float& value_rad, float low_deg, float high_deg);

}  // namespace relume::viewer
