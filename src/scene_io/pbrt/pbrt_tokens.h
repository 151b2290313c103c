// Splits pbrt files into tokens.
#pragma once

#include <deque>
#include <optional>
#include <string>
#include <string_view>

namespace relume::pbrt {

/// Place in a file, for messages.
struct Location {
  const std::string* file = nullptr;
  int line = 0;
};

/// Throws Error "FILE:LINE: `problem`"; `problem` ends with the remedy.
[[noreturn]] void fail(const Location& where, const std::string& problem);
/// "FILE:LINE".
std::string text_of(const Location& where);

struct Token {
  std::string_view text;  ///< without quotes
  bool quoted = false;
  Location where;

  bool is(std::string_view plain) const { return !quoted && text == plain; }
};

/// Tokens of one file: words, quoted strings and brackets. `name` and `text` must outlive it.
class Tokens {
 public:
  Tokens(const std::string& name, std::string_view text) : text_(text), where_{&name, 1} {}

  /// Next token; empty at the end. Throws Error for strings without an end, with zero
  /// bytes, or longer than paths.
  std::optional<Token> next();
  /// The same without taking it.
  const std::optional<Token>& peek();
  /// Next token. Throws Error at the end of the file; `wanted` names what is missing.
  Token require(const char* wanted);
  /// Next token, a quoted string. Throws Error otherwise.
  std::string require_string(const char* wanted);
  double require_number();

 private:
  void skip_space();
  std::optional<Token> scan();
  Token scan_string();

  std::string_view text_;  ///< the rest
  Location where_;
  std::optional<std::optional<Token>> peeked_;
  std::deque<std::string> unescaped_;  ///< strings with escapes, which tokens refer to
};

/// Value of a token; 0 or infinite beyond the range of double. Throws Error unless it is a number.
double number_of(const Token& token);

}  // namespace relume::pbrt
