// BSDFs of Mitsuba scenes.
#include <cmath>

#include <gtest/gtest.h>

#include "scene_io/testing/mitsuba_scene.h"

namespace relume {
namespace {

using testing::error_of;
using testing::load_mitsuba_bsdf;
using testing::load_mitsuba_text;
using testing::mentions;

Material material(const std::string& type, const std::string& parameters = "") {
  return load_mitsuba_bsdf("<bsdf type=\"" + type + "\">" + parameters + "</bsdf>").materials.at(0);
}

std::string number(const std::string& name, double value) {
  return "<float name=\"" + name + "\" value=\"" + std::to_string(value) + "\"/>";
}

std::string rgb(const std::string& name, const std::string& value) {
  return "<rgb name=\"" + name + "\" value=\"" + value + "\"/>";
}

void expect_near(const Rgb& a, const Rgb& b, float tolerance) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance);
}

TEST(MitsubaMaterials, Diffuse) {
  const Material m = material("diffuse", rgb("reflectance", "0.1, 0.2, 0.3"));
  EXPECT_EQ(m.base_color, Rgb(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(m.specular, 0);
  EXPECT_EQ(m.metallic, 0);
  EXPECT_EQ(material("diffuse").base_color, Rgb(0.5f));
  EXPECT_EQ(load_mitsuba_bsdf("").materials.at(0).base_color, Rgb(0.5f));
  // A constant reflectance is white in Mitsuba's RGB modes; constant light is not, under D65.
  EXPECT_EQ(material("diffuse", "<spectrum name=\"reflectance\" value=\"0.4\"/>").base_color, Rgb(0.4f));
  expect_near(material("diffuse", "<spectrum name=\"reflectance\" value=\"300:0.4, 900:0.4\"/>").base_color, Rgb(0.4f),
              2e-3f);
}

TEST(MitsubaMaterials, Conductors) {
  EXPECT_EQ(material("conductor").base_color, Rgb(1));
  EXPECT_EQ(material("conductor").roughness, 0);
  const Material eta = material("conductor", rgb("eta", "0.2, 0.9, 1.5") + rgb("k", "3, 2, 1"));
  const auto f0 = [](double n, double k) {
    return static_cast<float>(((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k));
  };
  expect_near(eta.base_color, Rgb(f0(0.2, 3), f0(0.9, 2), f0(1.5, 1)), 1e-5f);
  const Material gold =
      material("conductor", "<string name=\"material\" value=\"Au\"/>" + rgb("specular_reflectance", "0.5"));
  EXPECT_GT(gold.base_color.r, 0.45f);
  EXPECT_LT(gold.base_color.b, 0.25f);
  EXPECT_EQ(gold.metallic, 1);
  EXPECT_NE(error_of([] {
              material("conductor", "<string name=\"material\" value=\"unobtainium\"/>");
            }).find("'unobtainium' is unknown"),
            std::string::npos);
}

TEST(MitsubaMaterials, RoughnessIsTheRootOfAlpha) {
  const Material m = material("roughconductor", number("alpha", 0.09));
  EXPECT_NEAR(m.roughness, 0.3f, 1e-6f);
  EXPECT_EQ(m.microfacet_model, MicrofacetModel::beckmann);
  EXPECT_EQ(material("roughconductor", "<string name=\"distribution\" value=\"ggx\"/>").microfacet_model,
            MicrofacetModel::ggx);
  for (const bool along_u : {true, false}) {
    const Material a =
        material("roughconductor", number("alpha_u", along_u ? 0.36 : 0.04) + number("alpha_v", along_u ? 0.04 : 0.36));
    const float narrow = a.roughness * a.roughness;
    EXPECT_NEAR(narrow, 0.04f, 1e-6f);
    EXPECT_NEAR(narrow + (1 - narrow) * a.anisotropy * a.anisotropy, 0.36f, 1e-6f);  // KHR_materials_anisotropy
    EXPECT_NEAR(a.anisotropy_rotation_rad, along_u ? 0 : kPi / 2, 1e-6f);
  }
}

TEST(MitsubaMaterials, Dielectrics) {
  const Material glass =
      material("dielectric", "<string name=\"int_ior\" value=\"Diamond\"/><float name=\"ext_ior\" value=\"1\"/>");
  EXPECT_FLOAT_EQ(glass.ior, 2.419f);
  EXPECT_EQ(glass.transmission, 1);
  EXPECT_GT(glass.thickness, 0);
  EXPECT_EQ(glass.roughness, 0);
  EXPECT_FLOAT_EQ(material("dielectric").ior, 1.5046f / 1.000277f);
  EXPECT_NEAR(material("roughdielectric", number("alpha", 0.25)).roughness, 0.5f, 1e-6f);
  // A wall reflects R + (1 - R)² R + (1 - R)² R³ + … = 2R / (1 + R).
  const Material wall = material("thindielectric", number("int_ior", 1.5) + number("ext_ior", 1));
  EXPECT_EQ(wall.thickness, 0);
  EXPECT_NEAR(std::pow((wall.ior - 1) / (wall.ior + 1), 2), 0.08 / 1.04, 1e-6);
}

TEST(MitsubaMaterials, ABubbleIsADenserMediumOnTheOtherSide) {
  const Scene scene =
      load_mitsuba_bsdf("<bsdf type=\"dielectric\">" + number("int_ior", 1) + number("ext_ior", 1.25) + "</bsdf>");
  EXPECT_FLOAT_EQ(scene.materials[0].ior, 1.25f);
  const Mesh& mesh = scene.meshes[0];
  EXPECT_LT(glm::dot(mesh.normals[200], mesh.positions[200]), -0.99f);
}

TEST(MitsubaMaterials, Plastic) {
  const Material m = material("roughplastic", rgb("diffuse_reflectance", "0.1, 0.2, 0.7") + number("alpha", 0.16) +
                                                  rgb("specular_reflectance", "0.5, 0.25, 0.5"));
  EXPECT_EQ(m.base_color, Rgb(0.1f, 0.2f, 0.7f));
  EXPECT_NEAR(m.roughness, 0.4f, 1e-6f);
  EXPECT_FLOAT_EQ(m.ior, 1.49f / 1.000277f);
  EXPECT_EQ(m.specular, 0.5f);
  EXPECT_EQ(m.specular_color, Rgb(1, 0.5f, 1));
  EXPECT_EQ(material("plastic").roughness, 0);
}

TEST(MitsubaMaterials, LightBouncesInsideNonlinearPlastic) {
  // ρ (1 − F) / (1 − ρ F), F = 0.5899920 for 1.49 / 1.000277 by numerical integration.
  const Material m =
      material("plastic", rgb("diffuse_reflectance", "0.1, 0.5, 0.9") + "<boolean name=\"nonlinear\" value=\"true\"/>");
  expect_near(m.base_color, Rgb(0.0435715f, 0.2907842f, 0.7867837f), 2e-5f);
}

TEST(MitsubaMaterials, Principled) {
  const Material m =
      material("principled", rgb("base_color", "0.64, 0.16, 0.36") + number("roughness", 0.3) +
                                 number("metallic", 0.2) + number("specular", 0.5) + number("clearcoat", 0.7) +
                                 number("clearcoat_gloss", 1) + number("anisotropic", 0.5));
  EXPECT_EQ(m.base_color, Rgb(0.64f, 0.16f, 0.36f));
  EXPECT_EQ(m.metallic, 0.2f);
  EXPECT_NEAR(std::pow((m.ior - 1) / (m.ior + 1), 2), 0.04, 1e-5);  // 0.08 specular
  EXPECT_FLOAT_EQ(m.clearcoat, 0.7f / 4);                           // 0.25 clearcoat in its equation
  EXPECT_NEAR(m.clearcoat_roughness * m.clearcoat_roughness, 0.001f, 1e-6f);
  const double aspect = std::sqrt(1 - 0.9 * 0.5);
  EXPECT_NEAR(m.roughness * m.roughness, 0.09 * aspect, 1e-5);
  const Material glass =
      material("principled", rgb("base_color", "0.64, 0.16, 0.36") + number("spec_trans", 1) + number("eta", 1.3));
  EXPECT_FLOAT_EQ(glass.ior, 1.3f);
  EXPECT_GT(glass.thickness, 0);
  expect_near(glass.base_color, Rgb(0.8f, 0.4f, 0.6f), 1e-6f);
  const Material leaf = material("principledthin", number("diff_trans", 1.2));
  EXPECT_NEAR(leaf.diffuse_transmission, 0.6f, 1e-6f);
  EXPECT_EQ(leaf.thickness, 0);
}

TEST(MitsubaMaterials, AdaptersChangeTheirBsdf) {
  const std::string diffuse = "<bsdf type=\"diffuse\">" + rgb("reflectance", "0.2") + "</bsdf>";
  EXPECT_EQ(material("twosided", diffuse).base_color, Rgb(0.2f));
  const auto warnings_of = [](const std::string& shape, const std::string& bsdf) {
    return load_mitsuba_text("<shape type=\"" + shape + "\">" + bsdf + "</shape>").warnings;
  };
  EXPECT_TRUE(warnings_of("disk", "<bsdf type=\"twosided\">" + diffuse + "</bsdf>").empty());
  EXPECT_TRUE(warnings_of("sphere", diffuse).empty());  // nothing shows its back
  EXPECT_TRUE(mentions(warnings_of("disk", diffuse), "reflect on both sides"));
  const Material masked = material("mask", number("opacity", 0.25) + diffuse);
  EXPECT_EQ(masked.alpha, 0.25f);
  EXPECT_EQ(masked.alpha_mode, AlphaMode::blend);
  const std::string metal = "<bsdf type=\"conductor\"/>";
  const Material blend = material("blendbsdf", number("weight", 0.25) + diffuse + metal);
  EXPECT_FLOAT_EQ(blend.metallic, 0.25f);
  expect_near(blend.base_color, Rgb(0.4f), 1e-6f);  // 0.75 · 0.2 + 0.25
  EXPECT_EQ(blend.specular, 0);                     // of the diffuse BSDF; metals have none
  const Scene coin =
      load_mitsuba_bsdf("<bsdf type=\"blendbsdf\">" + number("weight", 0.25) + diffuse + metal + "</bsdf>");
  EXPECT_FLOAT_EQ(coin.materials.at(0).mix_share, 0.25f);
  EXPECT_EQ(coin.materials.at(static_cast<size_t>(coin.materials[0].mix_first)).metallic, 0);
  EXPECT_EQ(coin.materials.at(static_cast<size_t>(coin.materials[0].mix_second)).metallic, 1);
  const Material sieve = material("blendbsdf", number("weight", 0.25) + "<bsdf type=\"null\"/>" + diffuse);
  EXPECT_EQ(sieve.alpha, 0.25f);
  EXPECT_NE(error_of([] { material("twosided"); }).find("contains no BSDF"), std::string::npos);
}

TEST(MitsubaMaterials, NullShapesAreInvisible) {
  EXPECT_TRUE(load_mitsuba_bsdf("<bsdf type=\"null\"/>").nodes.empty());
  EXPECT_EQ(load_mitsuba_bsdf("<bsdf type=\"null\"/><emitter type=\"area\"/>").nodes.size(), 1u);
}

TEST(MitsubaMaterials, UnknownBsdfsAreGrey) {
  const Scene scene = load_mitsuba_bsdf("<bsdf type=\"hair\">" + number("roughness", 1) + "</bsdf>");
  EXPECT_EQ(scene.materials[0].base_color, Rgb(0.5f));
  EXPECT_TRUE(mentions(scene.warnings, "bsdf 'hair' is not supported; a diffuse surface replaces it"));
}

TEST(MitsubaMaterials, AreaLights) {
  const Scene scene = load_mitsuba_text("<shape type=\"rectangle\"><emitter type=\"area\">" +
                                        rgb("radiance", "3, 2, 1") + "</emitter></shape>");
  EXPECT_EQ(scene.materials[0].emission, Rgb(3, 2, 1));
  EXPECT_EQ(scene.materials[0].base_color, Rgb(0));
  EXPECT_FALSE(scene.materials[0].double_sided);
  const Scene shared =
      load_mitsuba_text("<emitter type=\"area\" id=\"lamp\"/><shape type=\"rectangle\"><ref id=\"lamp\"/></shape>");
  EXPECT_EQ(shared.materials[0].emission, Rgb(1));
  EXPECT_TRUE(shared.warnings.empty());
}

}  // namespace
}  // namespace relume
