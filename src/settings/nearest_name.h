// "Did you mean": the known name most similar to a mistyped one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace relume {

/// The name nearest to `name`, or one that begins or ends with it; empty if none is close. Compares edit distances,
/// ignoring case: insertion, deletion, replacement and swap of neighbours each cost one. The first wins a tie.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

/// "; did you mean 'cornell'?", or "; there are a, b and c" with all known names.
std::string suggestion(std::string_view name, const std::vector<std::string>& known);

/// "a", "a and b", "a, b and c".
std::string enumerate(const std::vector<std::string>& names);

}  // namespace relume
