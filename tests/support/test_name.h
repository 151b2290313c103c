// Makes names that GoogleTest accepts.
#pragma once

#include <cctype>
#include <string>

namespace relume::support {

/// `text` with an underscore for each character other than letters and digits.
inline std::string test_name(std::string text) {
  for (char& c : text) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return text;
}

}  // namespace relume::support
