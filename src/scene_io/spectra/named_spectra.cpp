#include "scene_io/spectra/named_spectra.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <glm/common.hpp>

#include "core/vec.h"
#include "scene_io/spectra/cie_tables.h"
#include "scene_io/spectra/conductor_table.h"

namespace relume {
namespace {

Spectrum spectrum_of(const std::array<float, kConductorSamples>& values) {
  Spectrum spectrum;
  for (int i = 0; i < kConductorSamples; ++i) {
    spectrum.wavelengths_nm.push_back(kConductorFirstNm + kConductorStepNm * static_cast<float>(i));
    spectrum.values.push_back(values[static_cast<size_t>(i)]);
  }
  return spectrum;
}

struct NamedDielectric {
  std::string_view name;
  float ior;
  float dispersion;
};

/// Glasses: refractiveindex.info (Schott). Substances: E. Hecht, "Optics", 4th edition, table 4.1, as in Mitsuba.
constexpr NamedDielectric kDielectrics[] = {
    {"BK7", 1.51680f, 0.3126f},
    {"BAF10", 1.67000f, 0.4251f},
    {"FK51A", 1.48656f, 0.2355f},
    {"LASF9", 1.85027f, 0.6210f},
    {"F5", 1.67272f, 0.6195f},
    {"SF5", 1.67272f, 0.6195f},
    {"F10", 1.72828f, 0.7024f},
    {"SF10", 1.72828f, 0.7024f},
    {"F11", 1.78474f, 0.7781f},
    {"SF11", 1.78474f, 0.7781f},
    {"vacuum", 1.0f, 0},
    {"helium", 1.000036f, 0},
    {"hydrogen", 1.000132f, 0},
    {"air", 1.000277f, 0},
    {"carbon dioxide", 1.00045f, 0},
    {"water", 1.3330f, 0},
    {"acetone", 1.36f, 0},
    {"ethanol", 1.361f, 0},
    {"carbon tetrachloride", 1.461f, 0},
    {"glycerol", 1.4729f, 0},
    {"benzene", 1.501f, 0},
    {"silicone oil", 1.52045f, 0},
    {"bromine", 1.661f, 0},
    {"water ice", 1.31f, 0},
    {"fused quartz", 1.458f, 0},
    {"pyrex", 1.470f, 0},
    {"acrylic glass", 1.49f, 0},
    {"polypropylene", 1.49f, 0},
    {"bk7", 1.5046f, 0},
    {"sodium chloride", 1.544f, 0},
    {"amber", 1.55f, 0},
    {"pet", 1.5750f, 0},
    {"diamond", 2.419f, 0},
};

struct NamedIlluminant {
  std::string_view name;
  Vec2 chromaticity;  ///< x, y of the 2° observer
};

/// CIE 015:2018; acesD60: SMPTE ST 2065-1.
constexpr NamedIlluminant kIlluminants[] = {
    {"A", {0.44757f, 0.40745f}},       {"D50", {0.34567f, 0.35850f}}, {"D65", {0.31271f, 0.32902f}},
    {"F1", {0.31310f, 0.33727f}},      {"F2", {0.37208f, 0.37529f}},  {"F3", {0.40910f, 0.39430f}},
    {"F4", {0.44018f, 0.40329f}},      {"F5", {0.31379f, 0.34531f}},  {"F6", {0.37790f, 0.38835f}},
    {"F7", {0.31292f, 0.32933f}},      {"F8", {0.34588f, 0.35875f}},  {"F9", {0.37417f, 0.37281f}},
    {"F10", {0.34609f, 0.35986f}},     {"F11", {0.38052f, 0.37713f}}, {"F12", {0.43695f, 0.40441f}},
    {"acesD60", {0.32168f, 0.33767f}},
};

template <typename Table>
auto find_named(const Table& table, std::string_view name) {
  return std::find_if(std::begin(table), std::end(table), [&](const auto& row) { return row.name == name; });
}

}  // namespace

std::optional<ComplexIndex> conductor_named(std::string_view name) {
  constexpr std::string_view kSuffix = "_palik";
  if (name.ends_with(kSuffix)) name.remove_suffix(kSuffix.size());
  const auto rows = conductor_rows();
  const auto row = find_named(rows, name);
  if (row == rows.end()) return std::nullopt;
  return ComplexIndex{spectrum_of(row->eta), spectrum_of(row->k)};
}

Rgb conductor_f0(const ComplexIndex& index, float outside) {
  Spectrum reflectance;
  for (int i = 0; i < kCieSamples; ++i) {
    const float nm = cie_wavelength_nm(i);
    const float eta = index.eta.at(nm) / outside;
    const float k = index.k.at(nm) / outside;
    const float sum = sqr(eta + 1) + sqr(k);
    reflectance.wavelengths_nm.push_back(nm);
    reflectance.values.push_back(is_finite(sum) && sum > 0 ? (sqr(eta - 1) + sqr(k)) / sum : 1.0f);
  }
  return rgb_of_reflectance(reflectance);
}

DielectricIndex dielectric_index(const Spectrum& eta) {
  constexpr float kLineC = 656.27f, kLineD = 587.56f, kLineF = 486.13f;  // nm
  DielectricIndex result;
  result.ior = eta.at(kLineD);
  if (result.ior > 1.001f)
    result.dispersion = std::clamp(20 * (eta.at(kLineF) - eta.at(kLineC)) / (result.ior - 1), 0.0f, 20.0f);
  return result;
}

std::optional<DielectricIndex> dielectric_named(std::string_view name) {
  const auto row = find_named(kDielectrics, name);
  if (row == std::end(kDielectrics)) return std::nullopt;
  return DielectricIndex{row->ior, row->dispersion};
}

std::optional<Rgb> illuminant_named(std::string_view name) {
  const auto row = find_named(kIlluminants, name);
  if (row == std::end(kIlluminants)) return std::nullopt;
  const Vec2& c = row->chromaticity;
  return glm::max(rec709_from_xyz(Vec3(c.x, c.y, 1 - c.x - c.y) / c.y), Rgb(0));
}

}  // namespace relume
