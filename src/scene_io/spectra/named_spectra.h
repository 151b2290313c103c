// Optical data by the names that pbrt and Mitsuba use.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "scene_io/spectra/spectrum.h"

namespace relume {

/// Complex index of refraction η + ik.
struct ComplexIndex {
  Spectrum eta;
  Spectrum k;
};

/// Index of a conductor: "Au", "Cu", "CuZn", "Cr", …, with or without the suffix "_palik" of Mitsuba's names.
std::optional<ComplexIndex> conductor_named(std::string_view name);

/// Colour of the reflectance at normal incidence of a conductor in a medium of index `outside`, in [0, 1].
Rgb conductor_f0(const ComplexIndex& index, float outside = 1);

/// Index at the Fraunhofer d line, and dispersion as in Material.
struct DielectricIndex {
  float ior = 1.5f;
  float dispersion = 0;
};

/// Dispersion of a tabulated index: 20 (n_F − n_C) / (n_d − 1), the index at 587.56 nm.
DielectricIndex dielectric_index(const Spectrum& eta);

/// Index of a glass by pbrt's names "BK7", "BAF10", "FK51A", "LASF9", "F5", "F10", "F11" (the last three are Schott's
/// SF5, SF10, SF11, which are found, too), or of a substance by Mitsuba's names in lower case ("water", "diamond", …),
/// without dispersion.
std::optional<DielectricIndex> dielectric_named(std::string_view name);

/// Colour, of luminance 1 before clamping, of a standard illuminant: "A", "D50", "D65", "F1" … "F12", "acesD60".
std::optional<Rgb> illuminant_named(std::string_view name);

}  // namespace relume
