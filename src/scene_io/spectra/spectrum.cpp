#include "scene_io/spectra/spectrum.h"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

#include "core/vec.h"
#include "scene_io/spectra/cie_tables.h"
#include "scene_io/spectra/color_space.h"

namespace relume {
namespace {

/// Planck's law, up to a factor.
double planck(double kelvin, double wavelength_m) {
  constexpr double kSecondRadiation = 1.438776877e-2;  // hc/k, m·K
  return 1 / (std::pow(wavelength_m, 5) * std::expm1(kSecondRadiation / (wavelength_m * kelvin)));
}

/// Sum of `weight` · s · (x̄, ȳ, z̄) over the table.
template <typename Weight>
Vec3 weighted_sum(const Spectrum& spectrum, const Weight& weight) {
  const CieTables& cie = cie_tables();
  Vec3 sum(0);
  for (int i = 0; i < kCieSamples; ++i) {
    const auto s = static_cast<size_t>(i);
    sum += spectrum.at(cie_wavelength_nm(i)) * weight(s) * Vec3(cie.x[s], cie.y[s], cie.z[s]);
  }
  return sum;
}

Rgb not_negative(const Rgb& color) { return glm::max(color, Rgb(0)); }

}  // namespace

float Spectrum::at(float nm) const {
  if (wavelengths_nm.empty() || !(nm >= wavelengths_nm.front() && nm <= wavelengths_nm.back())) return 0;
  const auto above = std::upper_bound(wavelengths_nm.begin(), wavelengths_nm.end(), nm);
  if (above == wavelengths_nm.end()) return values.back();
  const auto i = static_cast<size_t>(above - wavelengths_nm.begin());
  const float t = (nm - wavelengths_nm[i - 1]) / (wavelengths_nm[i] - wavelengths_nm[i - 1]);
  return lerp(values[i - 1], values[i], t);
}

Spectrum constant_spectrum(float value) { return {{300, 900}, {value, value}}; }

Spectrum blackbody_spectrum(float kelvin) {
  if (!(kelvin > 0 && kelvin <= 1e6f)) return {};
  constexpr double kWien = 2.897771955e-3;  // m·K
  const double largest = planck(kelvin, kWien / kelvin);
  Spectrum spectrum;
  for (int nm = 360; nm <= 830; nm += 5) {
    spectrum.wavelengths_nm.push_back(static_cast<float>(nm));
    spectrum.values.push_back(static_cast<float>(planck(kelvin, nm * 1e-9) / largest));
  }
  return spectrum;
}

bool is_valid(const Spectrum& spectrum) {
  const std::vector<float>& nm = spectrum.wavelengths_nm;
  if (nm.empty() || nm.size() != spectrum.values.size()) return false;
  for (size_t i = 0; i < nm.size(); ++i) {
    if (!is_finite(nm[i]) || !is_finite(spectrum.values[i]) || (i > 0 && !(nm[i] > nm[i - 1]))) return false;
  }
  return true;
}

Vec3 xyz_of_light(const Spectrum& spectrum) {
  float integral = 0;
  for (const float y : cie_tables().y) integral += y;
  return weighted_sum(spectrum, [](size_t) { return 1.0f; }) / integral;
}

Rgb rgb_of_light(const Spectrum& spectrum) { return not_negative(rec709_from_xyz(xyz_of_light(spectrum))); }

Rgb rgb_of_unit_light(const Spectrum& spectrum) {
  const Vec3 xyz = xyz_of_light(spectrum);
  return xyz.y > 0 ? not_negative(rec709_from_xyz(xyz / xyz.y)) : Rgb(0);
}

Rgb rgb_of_coefficient(const Spectrum& spectrum) {
  const CieTables& cie = cie_tables();
  float white = 0;
  for (size_t i = 0; i < kCieSamples; ++i) white += cie.d65[i] * cie.y[i];
  const Vec3 xyz = weighted_sum(spectrum, [&](size_t i) { return cie.d65[i]; }) / white;
  return not_negative(rec709_from_xyz(xyz));
}

Rgb rgb_of_reflectance(const Spectrum& spectrum) { return glm::min(rgb_of_coefficient(spectrum), Rgb(1)); }

Rgb rec709_from_xyz(const Vec3& xyz) {
  static const Mat3 kFromXyz = glm::inverse(xyz_from(ColorSpace::srgb));
  return kFromXyz * xyz;
}

}  // namespace relume
