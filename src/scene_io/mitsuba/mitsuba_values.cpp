#include "scene_io/mitsuba/mitsuba_values.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include "core/srgb.h"

namespace relume::mitsuba {
namespace {

constexpr std::string_view kSpace = " \t\r\n";

std::string_view trimmed(std::string_view text) {
  const size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

template <typename T>
std::optional<T> parse_whole(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::optional<Rgb> parse_hex_color(std::string_view digits) {
  if (digits.size() != 6) return std::nullopt;
  Rgb color(0);
  for (int c = 0; c < 3; ++c) {
    const std::string_view pair = digits.substr(2 * static_cast<size_t>(c), 2);
    int value = 0;
    const auto [end, error] = std::from_chars(pair.data(), pair.data() + 2, value, 16);
    if (error != std::errc() || end != pair.data() + 2 || value < 0) return std::nullopt;
    color[c] = linear_from_srgb(static_cast<float>(value) / 255.0f);
  }
  return color;
}

std::optional<SpectrumText> checked(SpectrumText text) {
  if (text.spectrum.wavelengths_nm.size() < 2 || !is_valid(text.spectrum)) return std::nullopt;
  return text;
}

/// Appends an entry; returns whether both texts are numbers.
bool append(Spectrum& spectrum, std::string_view wavelength, std::string_view value) {
  const std::optional<double> nm = parse_number(wavelength);
  const std::optional<double> number = parse_number(value);
  if (!nm || !number) return false;
  spectrum.wavelengths_nm.push_back(static_cast<float>(*nm));
  spectrum.values.push_back(static_cast<float>(*number));
  return true;
}

}  // namespace

std::vector<std::string_view> words_of(std::string_view text) {
  constexpr std::string_view kSeparators = ", \t\r\n";
  std::vector<std::string_view> words;
  for (size_t start = text.find_first_not_of(kSeparators); start != std::string_view::npos;) {
    const size_t end = std::min(text.find_first_of(kSeparators, start), text.size());
    words.push_back(text.substr(start, end - start));
    start = text.find_first_not_of(kSeparators, end);
  }
  return words;
}

std::optional<double> parse_number(std::string_view text) {
  const std::optional<double> value = parse_whole<double>(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<int64_t> parse_integer(std::string_view text) { return parse_whole<int64_t>(text); }

std::optional<std::vector<double>> parse_numbers(std::string_view text) {
  std::vector<double> numbers;
  for (const std::string_view word : words_of(text)) {
    const std::optional<double> number = parse_number(word);
    if (!number) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

std::optional<Rgb> parse_color(std::string_view text) {
  if (trimmed(text).starts_with('#')) return parse_hex_color(trimmed(text).substr(1));
  const std::optional<std::vector<double>> numbers = parse_numbers(text);
  if (!numbers || (numbers->size() != 1 && numbers->size() != 3)) return std::nullopt;
  const auto channel = [&](size_t c) { return static_cast<float>((*numbers)[numbers->size() == 1 ? 0 : c]); };
  return Rgb(channel(0), channel(1), channel(2));
}

std::optional<SpectrumText> parse_spectrum(std::string_view text) {
  SpectrumText result;
  const std::vector<std::string_view> words = words_of(text);
  if (words.size() == 1 && words[0].find(':') == std::string_view::npos) {
    const std::optional<double> value = parse_number(words[0]);
    if (!value) return std::nullopt;
    result.spectrum.values.push_back(static_cast<float>(*value));
    return result;
  }
  for (const std::string_view word : words) {
    const size_t colon = word.find(':');
    if (colon == std::string_view::npos || !append(result.spectrum, word.substr(0, colon), word.substr(colon + 1)))
      return std::nullopt;
  }
  return checked(std::move(result));
}

std::optional<SpectrumText> parse_spd(std::string_view text) {
  SpectrumText result;
  while (!text.empty()) {
    const size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    const std::vector<std::string_view> words = words_of(line.substr(0, line.find('#')));
    if (words.empty()) continue;
    if (words.size() != 2 || !append(result.spectrum, words[0], words[1])) return std::nullopt;
  }
  return checked(std::move(result));
}

std::string underscore_name(std::string_view camel_case) {
  const auto is_upper = [](char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; };
  std::string name;
  bool in_capitals = false;  // of a word such as "UV" in "toUV"
  for (size_t i = 0; i < camel_case.size(); ++i) {
    const char c = camel_case[i];
    const bool starts_word = is_upper(c) && i > 0 && std::islower(static_cast<unsigned char>(camel_case[i - 1]));
    if (starts_word) name += '_';
    in_capitals = is_upper(c) && (starts_word || in_capitals);
    name += in_capitals ? static_cast<char>(std::tolower(static_cast<unsigned char>(c))) : c;
  }
  return name;
}

}  // namespace relume::mitsuba
