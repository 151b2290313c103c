// Colours of spectra, as in Mitsuba's RGB modes.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "scene_io/mitsuba/mitsuba_parameters.h"

namespace relume::mitsuba {
namespace {

Rgb color_of_spectrum(const SpectrumText& text, SpectrumUse use) {
  if (use == SpectrumUse::light)
    return rgb_of_light(text.is_constant() ? constant_spectrum(text.spectrum.values[0]) : text.spectrum);
  return text.is_constant() ? Rgb(text.spectrum.values[0]) : rgb_of_reflectance(text.spectrum);
}

/// Colour in W/(sr·m²·nm), which Mitsuba takes for its unit of radiance.
Rgb blackbody_color(double kelvin) {
  constexpr double kPeak = 4.09567e-15;  // of Planck's law, W/(sr·m²·nm·K⁵)
  return rgb_of_light(blackbody_spectrum(static_cast<float>(kelvin))) * static_cast<float>(kPeak * std::pow(kelvin, 5));
}

/// Table of "regular" and "irregular".
SpectrumText table_of(const Parameters& p) {
  const std::optional<std::vector<double>> values = parse_numbers(p.text(p.has("values") ? "values" : "value", ""));
  std::optional<std::vector<double>> wavelengths;
  if (p.object().type == "irregular") {
    wavelengths = parse_numbers(p.text("wavelengths", ""));
  } else if (values && values->size() > 1) {
    const double first = p.number("wavelength_min", 360);
    const double step = (p.number("wavelength_max", 830) - first) / static_cast<double>(values->size() - 1);
    wavelengths.emplace();
    for (size_t i = 0; i < values->size(); ++i) wavelengths->push_back(first + step * static_cast<double>(i));
  }
  SpectrumText table;
  if (values && wavelengths) {
    table.spectrum.values.assign(values->begin(), values->end());
    table.spectrum.wavelengths_nm.assign(wavelengths->begin(), wavelengths->end());
  }
  if (!is_valid(table.spectrum)) p.fail("it needs as many numbers as increasing wavelengths");
  return table;
}

Rgb usable(const Rgb& color, SpectrumUse use) {
  const Rgb finite = is_finite(color) ? color : Rgb(0);
  return glm::clamp(finite, Rgb(0), Rgb(use == SpectrumUse::light ? kMaxRadiance : 1e6f));
}

}  // namespace

std::optional<Rgb> color_of(const Value& value, SpectrumUse use) {
  if (const auto* number = std::get_if<double>(&value)) return usable(Rgb(static_cast<float>(*number)), use);
  if (const auto* number = std::get_if<int64_t>(&value)) return usable(Rgb(static_cast<float>(*number)), use);
  if (const auto* color = std::get_if<Color>(&value)) return usable(color->rgb, use);
  if (const auto* spectrum = std::get_if<SpectrumText>(&value)) return usable(color_of_spectrum(*spectrum, use), use);
  return std::nullopt;
}

std::optional<Rgb> color_of(const Import& import, const Object& object, SpectrumUse use) {
  const Parameters p(import, object);
  if (object.type == "uniform" || object.type == "rawconstant" || object.type == "srgb" || object.type == "rgb" ||
      object.type == "spectrum") {
    const Value* value = p.value(p.has("value") ? "value" : "color");
    return value ? color_of(*value, use) : Rgb(1);
  }
  if (object.type == "d65") {
    if (!p.children({"texture"}).empty()) return std::nullopt;  // a texture times the white of Rec. 709
    const Value* color = p.value("color");
    const Rgb tint = color ? color_of(*color, use).value_or(Rgb(1)) : Rgb(1);
    return usable(tint * static_cast<float>(p.number("scale", 1)), use);
  }
  if (object.type == "blackbody") {
    p.ignore({"wavelength_min", "wavelength_max"});
    return usable(blackbody_color(p.number("temperature", 5000)) * static_cast<float>(p.number("scale", 1)), use);
  }
  if (object.type == "regular" || object.type == "irregular") return usable(color_of_spectrum(table_of(p), use), use);
  return std::nullopt;
}

Rgb color_parameter(const Import& import, const Parameters& parameters, const std::string& name, const Rgb& fallback,
                    SpectrumUse use) {
  std::optional<Rgb> color;
  if (const Value* value = parameters.value(name)) {
    color = color_of(*value, use);
    if (!color)
      parameters.fail(fmt::format("'{}' is no colour; write <rgb name=\"{}\" value=\"r, g, b\"/>", name, name));
  } else if (const Object* child = parameters.child(name)) {
    color = color_of(import, *child, use);
    if (!color)
      import.warnings.add(fmt::format("{}: a texture is not supported as its '{}'; the default replaces it",
                                      name_of(parameters.object()), name));
  }
  return color.value_or(fallback);
}

}  // namespace relume::mitsuba
