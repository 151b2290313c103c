// Widgets that several panels share.
#pragma once

#include <string>

#include "core/vec.h"

namespace relume::viewer {

/// Explains the previous item while the mouse hovers over it.
void tooltip(const std::string& text);

/// A heading with a line.
void heading(const char* text);

/// Edits the colour and strength of an emitter, whose product is the value. Returns whether it changed.
bool radiant_widget(const char* label, Rgb& value, const char* unit);

/// A number in [0, 1].
bool share_widget(const char* label, float& value, const char* help);

/// Edits an angle: degrees on the widget, radians in the value.
bool angle_widget(const char* label, float& value_rad, float low_deg, float high_deg);

}  // namespace relume::viewer
