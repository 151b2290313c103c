// Complex indices of refraction of metals and other conductors.
#pragma once

#include <array>
#include <span>
#include <string_view>

namespace relume {

inline constexpr int kConductorSamples = 21;
inline constexpr float kConductorFirstNm = 380;
inline constexpr float kConductorStepNm = 20;

/// Index η + ik at 380, 400, … 780 nm. Source: luxpop.com, whose tables pbrt and Mitsuba use, too; CuZn (brass):
/// refractiveindex.info.
struct ConductorRow {
  std::string_view name;  ///< as in Mitsuba, without "_palik"
  std::array<float, kConductorSamples> eta, k;
};

/// All rows, by name.
std::span<const ConductorRow> conductor_rows();

}  // namespace relume
