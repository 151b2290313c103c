#include "files/json_parse.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "relume/error.h"

namespace relume {
namespace {

constexpr int kMaxDepth = 256;

[[noreturn]] void fail_at(std::string_view text, size_t offset, const std::string& place, const std::string& problem) {
  const std::string_view before = text.substr(0, std::min(offset, text.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const size_t line_start = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
  throw Error(fmt::format("{}:{}:{}: {}", place, line, before.size() - line_start + 1, problem));
}

void check_depth(std::string_view text, const std::string& place) {
  int depth = 0;
  bool in_string = false;
  for (size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') {
        ++i;
      } else if (c == '"') {
        in_string = false;
      }
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      if (++depth > kMaxDepth)
        fail_at(text, i, place, fmt::format("the JSON is nested more than {} levels deep", kMaxDepth));
    } else if (c == '}' || c == ']') {
      --depth;
    }
  }
}

/// nlohmann's message without its error number and position: "… - unexpected end of input; expected ']'".
std::string problem_of(const char* what) {
  const std::string text = what;
  const size_t colon = text.find(": ");
  std::string problem = colon == std::string::npos ? text : text.substr(colon + 2);
  std::replace(problem.begin(), problem.end(), '\n', ' ');
  return problem;
}

}  // namespace

nlohmann::json parse_json(std::string_view text, const std::string& place) {
  check_depth(text, place);
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    fail_at(text, error.byte == 0 ? 0 : error.byte - 1, place, "JSON " + problem_of(error.what()));
  } catch (const nlohmann::json::exception&) {
    throw Error(fmt::format("{}: not valid JSON: a number is beyond 1.8e308; give a smaller one", place));
  }
}

}  // namespace relume
