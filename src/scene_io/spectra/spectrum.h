// Tabulated spectra and their colours in linear Rec. 709.
#pragma once

#include <vector>

#include "scene/scene.h"

namespace relume {

/// Values at increasing wavelengths, linear between them and 0 outside.
struct Spectrum {
  std::vector<float> wavelengths_nm;
  std::vector<float> values;

  /// Value at `nm`; 0 for an empty spectrum.
  float at(float nm) const;
};

/// The same value from 300 to 900 nm.
Spectrum constant_spectrum(float value);

/// Planck's law at 360, 365, … 830 nm, relative to its largest value at any wavelength, as in pbrt and Mitsuba. Black
/// for temperatures outside (0, 10⁶] K.
Spectrum blackbody_spectrum(float kelvin);

/// Whether the table is usable: as many values as wavelengths, all finite, the wavelengths increasing.
bool is_valid(const Spectrum& spectrum);

/// CIE XYZ of light, ∫ s (x̄, ȳ, z̄) dλ / ∫ ȳ dλ: a constant spectrum of 1 has Y = 1.
Vec3 xyz_of_light(const Spectrum& spectrum);

/// Linear Rec. 709 of light; colours outside the gamut are clamped at 0. D65 is grey.
Rgb rgb_of_light(const Spectrum& spectrum);

/// rgb_of_light() scaled to the luminance 1 (before clamping), to which pbrt scales the spectra of lights; 0 for a
/// black spectrum.
Rgb rgb_of_unit_light(const Spectrum& spectrum);

/// Linear Rec. 709 of a spectral coefficient (absorption, index) under D65, clamped at 0: a constant 1 is (1, 1, 1).
Rgb rgb_of_coefficient(const Spectrum& spectrum);

/// Linear Rec. 709 of a reflectance under D65, clamped to [0, 1]: a reflectance of 1 is white. Renderers of spectra
/// show this colour under their white light.
Rgb rgb_of_reflectance(const Spectrum& spectrum);

/// Rec. 709 from CIE XYZ with the white D65, without clamping.
Rgb rec709_from_xyz(const Vec3& xyz);

}  // namespace relume
