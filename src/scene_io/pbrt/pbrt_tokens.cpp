#include "scene_io/pbrt/pbrt_tokens.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>

#include <fmt/format.h>

#include "relume/error.h"

namespace relume::pbrt {
namespace {

constexpr std::string_view kSpace = " \t\r\n";
constexpr std::string_view kEndOfWord = " \t\r\n\"[]#";
constexpr size_t kShown = 40;        // characters of a token in a message
constexpr size_t kMaxString = 4096;  // characters of a name or path

char unescape(char c) {
  switch (c) {
    case 'b': return '\b';
    case 'f': return '\f';
    case 'n': return '\n';
    case 'r': return '\r';
    case 't': return '\t';
    default: return c;
  }
}

}  // namespace

std::string text_of(const Location& where) {
  return where.file ? fmt::format("{}:{}", *where.file, where.line) : std::string("defaults");
}

void fail(const Location& where, const std::string& problem) {
  throw Error(fmt::format("{}: {}", text_of(where), problem));
}

void Tokens::skip_space() {
  while (!text_.empty()) {
    if (text_[0] == '#') text_.remove_prefix(std::min(text_.find('\n'), text_.size()));
    const size_t end = std::min(text_.find_first_not_of(kSpace), text_.size());
    if (end == 0 && (text_.empty() || text_[0] != '#')) return;
    where_.line += static_cast<int>(std::count(text_.begin(), text_.begin() + static_cast<ptrdiff_t>(end), '\n'));
    text_.remove_prefix(end);
  }
}

Token Tokens::scan_string() {
  const Location start = where_;
  size_t end = 1;
  bool escapes = false;
  while (end < text_.size() && text_[end] != '"' && text_[end] != '\n') {
    escapes |= text_[end] == '\\';
    end += text_[end] == '\\' ? 2 : 1;
  }
  if (end >= text_.size() || text_[end] != '"') fail(start, "a string has no end; close it with \" on its line");
  std::string_view inner = text_.substr(1, end - 1);
  if (inner.size() > kMaxString)
    fail(start, fmt::format("a string has more than {} characters; shorten it", kMaxString));
  if (inner.find('\0') != std::string_view::npos) fail(start, "a string contains a zero byte; remove it");
  text_.remove_prefix(end + 1);
  if (escapes) {
    std::string& plain = unescaped_.emplace_back();
    for (size_t i = 0; i < inner.size(); ++i) plain += inner[i] == '\\' ? unescape(inner[++i]) : inner[i];
    inner = plain;
  }
  return {inner, true, start};
}

std::optional<Token> Tokens::scan() {
  skip_space();
  if (text_.empty()) return std::nullopt;
  if (text_[0] == '"') return scan_string();
  const bool is_bracket = text_[0] == '[' || text_[0] == ']';
  const size_t end = is_bracket ? 1 : std::min(text_.find_first_of(kEndOfWord), text_.size());
  const Token token{text_.substr(0, end), false, where_};
  text_.remove_prefix(end);
  return token;
}

std::optional<Token> Tokens::next() {
  if (!peeked_) return scan();
  const std::optional<Token> token = *peeked_;
  peeked_.reset();
  return token;
}

const std::optional<Token>& Tokens::peek() {
  if (!peeked_) peeked_ = scan();
  return *peeked_;
}

Token Tokens::require(const char* wanted) {
  const std::optional<Token> token = next();
  if (!token) fail(where_, fmt::format("the file ends where {} is expected; export or copy it again", wanted));
  return *token;
}

std::string Tokens::require_string(const char* wanted) {
  const Token token = require(wanted);
  if (!token.quoted)
    fail(token.where,
         fmt::format("'{}' stands where {} is expected; put it into quotes", token.text.substr(0, kShown), wanted));
  return std::string(token.text);
}

double Tokens::require_number() { return number_of(require("a number")); }

double number_of(const Token& token) {
  std::string_view text = token.text;
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_beyond_range = error == std::errc::result_out_of_range;
  if (is_beyond_range) value = std::strtod(std::string(text).c_str(), nullptr);  // 0 or infinite
  if (token.quoted || (error != std::errc() && !is_beyond_range) || rest != text.data() + text.size())
    fail(token.where, fmt::format("'{}' is not a number; correct it", token.text.substr(0, kShown)));
  return value;
}

}  // namespace relume::pbrt
