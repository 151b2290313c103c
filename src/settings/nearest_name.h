// "Did you mean": the known name that looks most like a mistyped one.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace relume {

/// The name with the smallest edit distance to `name` (insertion, deletion, replacement and swap of neighbours each
/// cost one; case is ignored) or one that `name` begins or ends; empty if none is close. The first wins a tie.
std::string nearest_name(std::string_view name, const std::vector<std::string>& known);

/// "; did you mean 'cornell'?", or else "; there are a, b and c" with all known names.
std::string suggestion(std::string_view name, const std::vector<std::string>& known);

/// "a", "a and b", "a, b and c".
std::string enumerate(const std::vector<std::string>& names);

}  // namespace relume
