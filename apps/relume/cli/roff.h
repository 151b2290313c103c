// Text as roff for manual pages: the escapes that groff and mandoc share, in ASCII.
#pragma once

#include <string>
#include <string_view>

namespace relume::cli {

/// Literal text, to be typed or copied: every hyphen is a minus sign.
std::string roff_literal(std::string_view text);

std::string roff_bold(std::string_view literal);
std::string roff_italic(std::string_view literal);

/// Running text: a new line after each sentence, lines of at most 78 characters; `code` in backquotes is bold. Ends
/// with a line break.
std::string roff_prose(std::string_view text);

}  // namespace relume::cli
