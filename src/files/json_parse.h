// JSON parsing with line and column in errors.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace relume {

/// Parses `text`. Throws Error "place:line:column: …" for syntax errors, numbers out of range and nesting beyond 256
/// levels. No real file nests deeper, and recursive readers would overflow the stack.
nlohmann::json parse_json(std::string_view text, const std::string& place);

}  // namespace relume
