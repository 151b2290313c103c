// Colours of pbrt's spectrum parameters.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "scene_io/pbrt/pbrt_parameters.h"
#include "scene_io/spectra/named_spectra.h"

namespace relume::pbrt {

/// Complex or real index of refraction: as a spectrum if `rgb` is empty.
struct IndexValue {
  Spectrum spectrum;
  std::optional<Rgb> rgb;
};

/// Converts the types rgb, blackbody and spectrum (numbers, name or file) to linear Rec. 709.
class Colors {
 public:
  /// `base_dir`: folder of spectrum files.
  Colors(std::filesystem::path base_dir, Warnings& warnings) : base_dir_(std::move(base_dir)), warnings_(warnings) {}

  /// Reflectance in [0, 1]; empty without the parameter.
  std::optional<Rgb> reflectance(const Parameters& parameters, std::string_view name);
  /// Coefficient such as absorption, not negative.
  std::optional<Rgb> coefficient(const Parameters& parameters, std::string_view name);
  /// Colour of a light. As pbrt does, scales blackbodies and spectra to the luminance 1, but not RGB.
  std::optional<Rgb> light(const Parameters& parameters, std::string_view name);
  /// Index of refraction by wavelength or by channel.
  std::optional<IndexValue> index(const Parameters& parameters, std::string_view name);
  /// Index of a dielectric: a number, or a spectrum, whose dispersion is kept.
  DielectricIndex dielectric(const Parameters& parameters, std::string_view name);

  /// The spectrum of a parameter of type "blackbody" or "spectrum". Throws Error for tables that are no spectrum.
  Spectrum spectrum_of(const Parameter& parameter);

 private:
  std::optional<Rgb> rgb_of(const Parameter& parameter) const;
  Spectrum named(const Parameter& parameter, const std::string& name);
  const Spectrum& from_file(const Parameter& parameter, const std::string& name);

  std::filesystem::path base_dir_;
  Warnings& warnings_;
  std::map<std::string, Spectrum> files_;
};

/// Reflectance at normal incidence of a conductor of these indices in a medium of index `outside`.
Rgb conductor_reflectance(const IndexValue& eta, const IndexValue& k, float outside);

}  // namespace relume::pbrt
