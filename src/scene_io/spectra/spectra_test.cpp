// The numbers come from sums over the 1 nm table of the CIE, in double precision.
#include <gtest/gtest.h>

#include "scene_io/spectra/cie_tables.h"
#include "scene_io/spectra/color_space.h"
#include "scene_io/spectra/named_spectra.h"

namespace relume {
namespace {

void expect_near(const Rgb& a, const Rgb& b, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << c;
}

Spectrum d65() {
  Spectrum spectrum;
  for (int i = 0; i < kCieSamples; ++i) {
    spectrum.wavelengths_nm.push_back(cie_wavelength_nm(i));
    spectrum.values.push_back(cie_tables().d65[static_cast<size_t>(i)]);
  }
  return spectrum;
}

TEST(Spectra, TablesInterpolate) {
  const Spectrum s{{400, 500, 600}, {1, 3, 2}};
  EXPECT_EQ(s.at(450), 2);
  EXPECT_EQ(s.at(600), 2);
  EXPECT_EQ(s.at(399), 0);
  EXPECT_EQ(Spectrum{}.at(500), 0);
  EXPECT_TRUE(is_valid(s));
  EXPECT_FALSE(is_valid({{400, 400}, {1, 1}}));
  EXPECT_FALSE(is_valid({{400}, {}}));
}

TEST(Spectra, WhitesAreWhite) {
  expect_near(rgb_of_unit_light(d65()), Rgb(1), 2e-3f);
  expect_near(rgb_of_reflectance(constant_spectrum(0.5f)), Rgb(0.5f), 1e-3f);
  EXPECT_NEAR(xyz_of_light(constant_spectrum(2)).y, 2, 1e-5);
  expect_near(*illuminant_named("D65"), Rgb(1), 1e-4f);
}

TEST(Spectra, BlackbodiesHaveTheirColour) {
  expect_near(rgb_of_unit_light(blackbody_spectrum(2700)), {1.9348f, 0.8036f, 0.1918f}, 4e-3f);
  expect_near(rgb_of_unit_light(blackbody_spectrum(6500)), {1.0432f, 0.9836f, 1.0352f}, 4e-3f);
  EXPECT_NEAR(blackbody_spectrum(5000).at(580), 1, 1e-3);  // Wien: 579.6 nm
  EXPECT_EQ(rgb_of_unit_light(blackbody_spectrum(-1)), Rgb(0));
}

TEST(Spectra, ConductorsReflectTheirColour) {
  expect_near(conductor_f0(*conductor_named("Au")), {1, 0.7825f, 0.3434f}, 5e-3f);
  expect_near(conductor_f0(*conductor_named("Cu")), {0.9553f, 0.6376f, 0.5382f}, 5e-3f);
  expect_near(conductor_f0(*conductor_named("CuZn")), {0.9097f, 0.7783f, 0.4228f}, 5e-3f);
  expect_near(conductor_f0(*conductor_named("Ag_palik")), {0.9715f, 0.9599f, 0.9153f}, 5e-3f);
  // Index 1.5 without absorption: (0.5 / 2.5)², and nothing in a medium of the same index.
  const ComplexIndex glass{constant_spectrum(1.5f), constant_spectrum(0)};
  expect_near(conductor_f0(glass), Rgb(0.04f), 1e-4f);
  expect_near(conductor_f0(glass, 1.5f), Rgb(0), 1e-5f);
  EXPECT_FALSE(conductor_named("Unobtainium"));
}

TEST(Spectra, GlassesHaveTheirIndex) {
  EXPECT_NEAR(dielectric_named("BK7")->ior, 1.5168f, 1e-4);
  EXPECT_NEAR(20 / dielectric_named("BK7")->dispersion, 64.0f, 0.2f);
  EXPECT_EQ(dielectric_named("diamond")->ior, 2.419f);
  EXPECT_FALSE(dielectric_named("fudge"));
  const DielectricIndex tabulated = dielectric_index({{400, 700}, {1.6f, 1.5f}});
  EXPECT_NEAR(tabulated.ior, 1.53748f, 1e-4);
  EXPECT_NEAR(tabulated.dispersion, 20 * 0.056713f / 0.53748f, 1e-3);
}

TEST(Spectra, ColourSpacesKeepTheirWhite) {
  for (const char* name : {"srgb", "dci-p3", "rec2020"})
    expect_near(rec709_from(*color_space_named(name)) * Rgb(1), Rgb(1), 1e-4f);
  // The white of ACES is D60.
  expect_near(rec709_from(ColorSpace::aces2065_1) * Rgb(1), *illuminant_named("acesD60"), 1e-4f);
  // ITU-R BT.2087, table 2, inverted.
  expect_near(rec709_from(ColorSpace::rec2020) * Rgb(1, 0, 0), {1.6605f, -0.1246f, -0.0182f}, 1e-3f);
  EXPECT_FALSE(color_space_named("cmyk"));
}

}  // namespace
}  // namespace relume
