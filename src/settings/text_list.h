// Lists that people write: "a, b,c".
#pragma once

#include <string_view>
#include <vector>

namespace relume {

/// Without blanks (spaces, tabs and carriage returns) at either end.
std::string_view trimmed(std::string_view text);

/// What stands between commas, trimmed; empty parts are left out.
std::vector<std::string_view> split_at_commas(std::string_view text);

}  // namespace relume
