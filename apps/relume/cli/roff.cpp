#include "cli/roff.h"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>

namespace relume::cli {
namespace {

constexpr size_t kLineWidth = 78;

/// Number of bytes of the UTF-8 sequence whose first byte is `lead`.
size_t sequence_length(unsigned char lead) {
  if (lead >= 0xf0) return 4;
  if (lead >= 0xe0) return 3;
  return lead >= 0xc0 ? 2 : 1;
}

/// The character at `text[at]` as roff; advances `at` past it. A hyphen stays a hyphen.
std::string next_character(std::string_view text, size_t& at) {
  const auto lead = static_cast<unsigned char>(text[at]);
  const size_t length = std::min(sequence_length(lead), text.size() - at);
  if (length > 1) {
    uint32_t code_point = lead & (0xffu >> (length + 1));
    for (size_t i = 1; i < length; ++i)
      code_point = code_point << 6 | (static_cast<unsigned char>(text[at + i]) & 0x3fu);
    at += length;
    return fmt::format("\\[u{:04X}]", code_point);
  }
  ++at;
  switch (lead) {
    case '\\': return "\\e";
    case '\'': return "\\(aq";
    case '`': return "\\(ga";
    case '^': return "\\(ha";
    case '~': return "\\(ti";
    case '"': return "\\(dq";
    default: return std::string(1, static_cast<char>(lead));
  }
}

/// Escapes a leading dot, which would start a request. Apostrophes are escaped already.
std::string guarded(const std::string& line) { return line.starts_with('.') ? "\\&" + line : line; }

/// Whether the word is a flag, path or number, whose hyphens are minus signs.
bool is_literal(std::string_view word) {
  const size_t first = word.find_first_not_of("(`'\"");
  return first != word.npos && (word[first] == '-' || word.find('/') != word.npos || word.find("--") != word.npos);
}

/// `in_code`: whether the word begins inside backquotes; updated for the next word.
std::string prose_word(std::string_view word, bool& in_code) {
  const bool literal = is_literal(word);
  std::string result;
  for (size_t at = 0; at < word.size();) {
    if (word[at] == '`') {
      in_code = !in_code;
      result += in_code ? "\\fB" : "\\fR";
      ++at;
    } else if (word[at] == '-') {
      result += in_code || literal ? "\\-" : "-";
      ++at;
    } else {
      result += next_character(word, at);
    }
  }
  return result;
}

}  // namespace

std::string roff_literal(std::string_view text) {
  std::string result;
  for (size_t at = 0; at < text.size();) {
    const std::string character = next_character(text, at);
    result += character == "-" ? "\\-" : character;
  }
  return guarded(result);
}

std::string roff_bold(std::string_view literal) { return "\\fB" + roff_literal(literal) + "\\fR"; }

std::string roff_italic(std::string_view literal) { return "\\fI" + roff_literal(literal) + "\\fR"; }

std::string roff_prose(std::string_view text) {
  std::string result;
  std::string line;
  bool in_code = false;
  const auto end_line = [&] {
    if (!line.empty()) result += guarded(line) + "\n";
    line.clear();
  };
  while (!text.empty()) {
    const size_t length = std::min(text.find_first_of(" \n"), text.size());
    const std::string_view word = text.substr(0, length);
    text.remove_prefix(std::min(length + 1, text.size()));
    if (word.empty()) continue;
    const std::string roff = prose_word(word, in_code);
    if (line.size() + 1 + roff.size() > kLineWidth) end_line();
    line += (line.empty() ? "" : " ") + roff;
    if (word.ends_with('.') && !in_code) end_line();
  }
  end_line();
  return result;
}

}  // namespace relume::cli
