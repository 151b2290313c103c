// Durations in text form.
#pragma once

#include <string_view>

namespace relume {

/// Seconds given by `text`: "10", "10s", "500ms", "2min", "1.5h", "1h30min". Throws Error that begins with `place`.
double parse_duration_s(std::string_view text, std::string_view place);

}  // namespace relume
