// JSON text to a document, with errors that say line and column.
#pragma once

#include <string>
#include <string_view>

#include <nlohmann/json_fwd.hpp>

namespace relume {

/// Parses `text`. Throws Error "place:line:column: …" for syntax errors, for numbers out of range and for nesting
/// beyond 256 levels, which no real file has and which would exhaust the stack of recursive readers.
nlohmann::json parse_json(std::string_view text, const std::string& place);

}  // namespace relume
