// Parses the values in Mitsuba's XML attributes: numbers, lists, colours and spectra.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene_io/spectra/spectrum.h"

namespace relume::mitsuba {

/// Words of a text, separated by commas and white space.
std::vector<std::string_view> words_of(std::string_view text);

/// The finite number that is the whole text, apart from white space around it; std::nullopt otherwise.
std::optional<double> parse_number(std::string_view text);
/// The same for integers.
std::optional<int64_t> parse_integer(std::string_view text);

/// Numbers of a list; std::nullopt if a word is no number.
std::optional<std::vector<double>> parse_numbers(std::string_view text);

/// Linear colour of one or three numbers, or of #rrggbb, which is decoded from sRGB.
std::optional<Rgb> parse_color(std::string_view text);

/// A spectrum as in Mitsuba's XML. A constant one has no wavelengths and one value.
struct SpectrumText {
  Spectrum spectrum;

  bool is_constant() const { return spectrum.wavelengths_nm.empty(); }
};

/// One number, or at least two pairs "wavelength:value" of increasing wavelengths.
std::optional<SpectrumText> parse_spectrum(std::string_view text);

/// Contents of an .spd file: a wavelength and a value per line; '#' starts a comment.
std::optional<SpectrumText> parse_spd(std::string_view text);

/// Name of a property since Mitsuba 2: "toWorld" becomes "to_world".
std::string underscore_name(std::string_view camel_case);

}  // namespace relume::mitsuba
