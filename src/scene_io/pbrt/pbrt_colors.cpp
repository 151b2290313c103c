#include "scene_io/pbrt/pbrt_colors.h"

#include <charconv>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "core/vec.h"
#include "files/bytes.h"
#include "relume/error.h"
#include "scene_io/image_search.h"

namespace relume::pbrt {
namespace {

const std::initializer_list<std::string_view> kSpectra = {"rgb", "blackbody", "spectrum"};
constexpr size_t kMaxSamples = size_t{1} << 20;

/// Numbers of a text file with comments after '#'. Stops at anything else.
std::vector<double> numbers_in(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n,";
  std::vector<double> numbers;
  while (numbers.size() < 2 * kMaxSamples) {
    const size_t start = text.find_first_not_of(kSpace);
    if (start == std::string_view::npos) break;
    text.remove_prefix(start);
    if (text[0] == '#') {
      text.remove_prefix(std::min(text.find('\n'), text.size()));
      continue;
    }
    double value = 0;
    const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc()) return {};
    numbers.push_back(value);
    text.remove_prefix(static_cast<size_t>(rest - text.data()));
  }
  return numbers;
}

Spectrum interleaved(const std::vector<double>& numbers) {
  Spectrum spectrum;
  if (numbers.size() % 2 != 0) return spectrum;
  for (size_t i = 0; i < numbers.size(); i += 2) {
    spectrum.wavelengths_nm.push_back(narrow(numbers[i]));
    spectrum.values.push_back(narrow(numbers[i + 1]));
  }
  return spectrum;
}

Rgb not_negative(const Rgb& color) {
  Rgb result;
  for (int c = 0; c < 3; ++c) result[c] = color[c] > 0 && is_finite(color[c]) ? color[c] : 0.0f;
  return result;
}

}  // namespace

std::optional<Rgb> Colors::rgb_of(const Parameter& p) const {
  if (p.type != "rgb") return std::nullopt;
  if (p.numbers.size() < 3) fail(p.where, fmt::format("'rgb {}' has fewer than three numbers; add them", p.name));
  return rec709_from(p.space) * Rgb(narrow(p.numbers[0]), narrow(p.numbers[1]), narrow(p.numbers[2]));
}

const Spectrum& Colors::from_file(const Parameter& p, const std::string& name) {
  const auto [entry, is_new] = files_.try_emplace(name);
  if (!is_new) return entry->second;
  const Bytes bytes = read_reference(find_inside(base_dir_, name, text_of(p.where)), p.where);
  Spectrum spectrum = interleaved(numbers_in({reinterpret_cast<const char*>(bytes.data()), bytes.size()}));
  if (!is_valid(spectrum))
    fail(p.where, fmt::format("{} is no spectrum; give pairs of an increasing wavelength and a value", name));
  return entry->second = std::move(spectrum);
}

Spectrum Colors::named(const Parameter& p, const std::string& name) {
  const std::string_view text = name;
  if (text.starts_with("metal-")) {
    const size_t end = text.rfind('-');
    const auto metal = conductor_named(end > 6 ? text.substr(6, end - 6) : std::string_view());
    if (metal && text.ends_with("-eta")) return metal->eta;
    if (metal && text.ends_with("-k")) return metal->k;
  }
  if (text.starts_with("glass-")) {
    if (const auto glass = dielectric_named(text.substr(6))) return constant_spectrum(glass->ior);
  }
  return from_file(p, name);
}

Spectrum Colors::spectrum_of(const Parameter& p) {
  if (p.type == "blackbody") return blackbody_spectrum(p.numbers.empty() ? 0 : narrow(p.numbers[0]));
  if (!p.strings.empty()) return named(p, p.strings[0]);
  Spectrum spectrum = interleaved(p.numbers);
  if (!is_valid(spectrum))
    fail(p.where,
         fmt::format("'spectrum {}' is no spectrum; give pairs of an increasing wavelength and a value", p.name));
  return spectrum;
}

std::optional<Rgb> Colors::reflectance(const Parameters& parameters, std::string_view name) {
  const Parameter* p = parameters.find(name, kSpectra);
  if (!p) return std::nullopt;
  if (const auto rgb = rgb_of(*p)) return glm::min(not_negative(*rgb), Rgb(1));
  return rgb_of_reflectance(spectrum_of(*p));
}

std::optional<Rgb> Colors::coefficient(const Parameters& parameters, std::string_view name) {
  const Parameter* p = parameters.find(name, kSpectra);
  if (!p) return std::nullopt;
  if (const auto rgb = rgb_of(*p)) return not_negative(*rgb);
  return rgb_of_coefficient(spectrum_of(*p));
}

std::optional<Rgb> Colors::light(const Parameters& parameters, std::string_view name) {
  const Parameter* p = parameters.find(name, kSpectra);
  if (!p) return std::nullopt;
  if (const auto rgb = rgb_of(*p)) return not_negative(*rgb);
  constexpr std::string_view kStandard = "stdillum-", kOther = "illum-";
  if (p->type == "spectrum" && !p->strings.empty()) {
    std::string_view illuminant = p->strings[0];
    for (const std::string_view prefix : {kStandard, kOther}) {
      if (illuminant.starts_with(prefix)) illuminant.remove_prefix(prefix.size());
    }
    if (const auto color = illuminant_named(illuminant)) return color;
  }
  return rgb_of_unit_light(spectrum_of(*p));
}

std::optional<IndexValue> Colors::index(const Parameters& parameters, std::string_view name) {
  const Parameter* p = parameters.find(name, kSpectra);
  if (!p) return std::nullopt;
  if (const auto rgb = rgb_of(*p)) return IndexValue{{}, not_negative(*rgb)};
  return IndexValue{spectrum_of(*p), std::nullopt};
}

DielectricIndex Colors::dielectric(const Parameters& parameters, std::string_view name) {
  DielectricIndex result{parameters.number(name, 1.5f), 0};
  if (const Parameter* p = parameters.find(name, kSpectra)) {
    const bool is_glass = p->type == "spectrum" && !p->strings.empty() && p->strings[0].starts_with("glass-");
    const auto glass = is_glass ? dielectric_named(std::string_view(p->strings[0]).substr(6)) : std::nullopt;
    const auto rgb = rgb_of(*p);
    result = glass ? *glass : rgb ? DielectricIndex{rgb->g, 0} : dielectric_index(spectrum_of(*p));
  }
  if (!(result.ior >= 1 && result.ior <= 100)) {
    warnings_.add(
        fmt::format("an index of refraction of {} is not supported; the nearest of 1 to 100 is used", result.ior));
    result.ior = result.ior > 100 ? 100.0f : 1.0f;
  }
  return result;
}

Rgb conductor_reflectance(const IndexValue& eta, const IndexValue& k, float outside) {
  if (!eta.rgb && !k.rgb) return conductor_f0({eta.spectrum, k.spectrum}, outside);
  const Rgb n = (eta.rgb ? *eta.rgb : rgb_of_coefficient(eta.spectrum)) / outside;
  const Rgb absorption = (k.rgb ? *k.rgb : rgb_of_coefficient(k.spectrum)) / outside;
  Rgb f0;
  for (int c = 0; c < 3; ++c) {
    const float sum = sqr(n[c] + 1) + sqr(absorption[c]);
    f0[c] = is_finite(sum) ? (sqr(n[c] - 1) + sqr(absorption[c])) / sum : 1.0f;
  }
  return f0;
}

}  // namespace relume::pbrt
