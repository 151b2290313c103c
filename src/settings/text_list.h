// Comma-separated lists: "a, b,c".
#pragma once

#include <string_view>
#include <vector>

namespace relume {

/// Removes blanks (spaces, tabs and carriage returns) at both ends.
std::string_view trimmed(std::string_view text);

/// Trimmed parts between commas, without empty ones.
std::vector<std::string_view> split_at_commas(std::string_view text);

}  // namespace relume
