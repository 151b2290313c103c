// Tables of the CIE: the 1931 standard observer and illuminant D65 (CIE 018:2019, tables 1 and 6).
#pragma once

#include <array>

namespace relume {

inline constexpr int kCieSamples = 81;
inline constexpr float kCieFirstNm = 380;
inline constexpr float kCieStepNm = 5;

/// Values at 380, 385, … 780 nm.
struct CieTables {
  std::array<float, kCieSamples> x, y, z;  ///< colour matching functions of the 2° observer
  std::array<float, kCieSamples> d65;      ///< relative power, 100 at 560 nm
};

const CieTables& cie_tables();

/// Wavelength of sample `i`.
constexpr float cie_wavelength_nm(int i) { return kCieFirstNm + kCieStepNm * static_cast<float>(i); }

}  // namespace relume
