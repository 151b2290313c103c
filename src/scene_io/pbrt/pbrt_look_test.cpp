// Materials, textures, lights and environments. Numbers come from pbrt's definitions.
#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "core/srgb.h"
#include "relume/image_io.h"
#include "relume/scene_io.h"
#include "scene_io/pbrt/equal_area.h"
#include "scene_io/pbrt/pbrt_loader.h"
#include "scene_io/pbrt/pbrt_surface.h"
#include "scene_io/testing/scene_files.h"

namespace relume {
namespace {

using testing::mentions;
using testing::SceneFolder;
using testing::to_bytes;

Scene load(const std::string& text) { return load_pbrt_from_memory(to_bytes(text), "/nonexistent", "a.pbrt"); }

Material material(const std::string& text) {
  return load("WorldBegin\n" + text + "\nShape \"sphere\"\n").materials.at(0);
}

void expect_near(const Rgb& a, const Rgb& b, float tolerance = 1e-3f) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], tolerance) << c;
}

TEST(PbrtLook, DiffuseIsLambertian) {
  const Material m = material("Material \"diffuse\" \"rgb reflectance\" [0.1 0.2 0.3]");
  EXPECT_EQ(m.base_color, Rgb(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(m.specular, 0);
  EXPECT_EQ(m.metallic, 0);
  expect_near(material("Material \"diffuse\"").base_color, Rgb(0.5f));
  // Half of all wavelengths.
  expect_near(material("Material \"diffuse\" \"spectrum reflectance\" [300 .5 900 .5]").base_color, Rgb(0.5f), 2e-3f);
}

TEST(PbrtLook, RoughnessBecomesPerceptual) {
  // Remapped: α = √0.0625 = 0.25, and α = r².
  EXPECT_FLOAT_EQ(material("Material \"conductor\" \"float roughness\" 0.0625").roughness, 0.5f);
  EXPECT_FLOAT_EQ(material("Material \"conductor\" \"float roughness\" 0.25 \"bool remaproughness\" false").roughness,
                  0.5f);
  const Material stretched = material(
      "Material \"conductor\" \"float uroughness\" 0.36 \"float vroughness\" 0.04 \"bool remaproughness\" false");
  EXPECT_FLOAT_EQ(stretched.roughness, 0.2f);
  // KHR_materials_anisotropy: α_t = mix(α_b, 1, strength²) = 0.04 + 0.96 · strength² = 0.36.
  EXPECT_NEAR(0.04f + 0.96f * stretched.anisotropy * stretched.anisotropy, 0.36f, 1e-5);
  EXPECT_EQ(stretched.anisotropy_rotation_rad, 0);
}

TEST(PbrtLook, ConductorsHaveTheirReflectance) {
  const Material gold =
      material("Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" \"metal-Au-k\"");
  EXPECT_EQ(gold.metallic, 1);
  expect_near(gold.base_color, {1, 0.7825f, 0.3434f}, 5e-3f);
  expect_near(material("Material \"conductor\"").base_color, {0.9553f, 0.6376f, 0.5382f}, 5e-3f);  // copper
  expect_near(material("Material \"conductor\" \"rgb eta\" [2 1 1] \"rgb k\" [1 0 2]").base_color,
              {0.2f, 0, 0.5f});  // ((n - 1)² + k²) / ((n + 1)² + k²)
}

TEST(PbrtLook, CoatsDarkenTheirBase) {
  // Index 1.5: F_dr = 0.5963 (numerical integral), 0.5 · 0.4037 / (1 - 0.2982) = 0.2876.
  const Material m = material("Material \"coateddiffuse\" \"rgb reflectance\" [0.5 0 1] \"float roughness\" 0");
  expect_near(m.base_color, {0.2876f, 0, 1}, 2e-3f);
  EXPECT_EQ(m.ior, 1.5f);
  EXPECT_EQ(m.specular, 1);
  const Material coated = material("Material \"coatedconductor\" \"float interface.roughness\" 0.0625");
  EXPECT_EQ(coated.clearcoat, 1);
  EXPECT_FLOAT_EQ(coated.clearcoat_roughness, 0.5f);
  EXPECT_EQ(coated.metallic, 1);
  // η = 1 and κ = 2 √(R / (1 - R)), both divided by 1.5: R = 0.5 gives (1/9 + 16/9) / (25/9 + 16/9).
  const Material gold = material("Material \"coatedconductor\" \"rgb reflectance\" [1 0.5 0]");
  expect_near(gold.base_color, {1, 17.0f / 41, 0.04f}, 1e-5f);
  expect_near(pbrt::reflectance_without_coat(gold.base_color, 1.5f), {1, 0.5f, 0}, 1e-5f);
}

TEST(PbrtLook, DielectricsRefractAndAbsorb) {
  const Material m = material(
      "MakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 2 4] \"rgb sigma_s\" [0 0 0]\n"
      "MediumInterface \"m\" \"\"\nMaterial \"dielectric\" \"spectrum eta\" \"glass-BK7\"");
  EXPECT_NEAR(m.ior, 1.5168f, 1e-4);
  EXPECT_GT(m.dispersion, 0.3f);
  EXPECT_GT(m.thickness, 0);
  EXPECT_EQ(m.transmission, 1);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(std::log(m.attenuation_color[c]) / m.attenuation_distance, -std::exp2(c), 1e-3);
  // Both sides of a wall: 2 · 0.04 / 1.04.
  const float ior = material("Material \"thindielectric\"").ior;
  EXPECT_NEAR(std::pow((ior - 1) / (ior + 1), 2), 0.08f / 1.04f, 1e-5);
  EXPECT_NEAR(pbrt::index_of_thin_wall(ior), 1.5f, 1e-4);
}

TEST(PbrtLook, DiffuseTransmissionSplits) {
  const Material m =
      material("Material \"diffusetransmission\" \"rgb reflectance\" [0.2 0.1 0] \"rgb transmittance\" [0.3 0.6 0.3]");
  expect_near(m.base_color * (1 - m.diffuse_transmission), {0.2f, 0.1f, 0});
  expect_near(m.diffuse_transmission_color * m.diffuse_transmission, {0.3f, 0.6f, 0.3f});
}

TEST(PbrtLook, MixedDiffuseMaterialsAverage) {
  const Material m = material(
      "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"rgb reflectance\" [1 0 0]\n"
      "MakeNamedMaterial \"b\" \"string type\" \"diffuse\" \"rgb reflectance\" [0 0 1]\n"
      "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" 0.25");
  expect_near(m.base_color, {0.75f, 0, 0.25f});
}

TEST(PbrtLook, MixedMaterialsKeepTheNormalMapOfTheirParts) {
  const SceneFolder folder;
  folder.write("n.png", testing::solid_png(1, 1, 128, 128, 255, 255));
  const Scene scene = load_scene(folder.write("a.pbrt",
                                              "WorldBegin\nMakeNamedMaterial \"a\" \"string type\" \"diffuse\" "
                                              "\"string normalmap\" \"n.png\"\nMakeNamedMaterial \"b\" "
                                              "\"string type\" \"diffuse\" \"string normalmap\" \"n.png\"\nMaterial "
                                              "\"mix\" \"string materials\" [\"a\" \"b\"] \"string "
                                              "normalmap\" \"other.png\"\nShape \"sphere\"\n"));
  EXPECT_TRUE(scene.materials.at(0).normal_texture.used());
  EXPECT_TRUE(mentions(scene.warnings, "'string normalmap' of material 'mix' is ignored"));  // as in pbrt
  const Scene one = load_scene(folder.write("b.pbrt",
                                            "WorldBegin\nMakeNamedMaterial \"a\" \"string type\" \"diffuse\" "
                                            "\"string normalmap\" \"n.png\"\nMakeNamedMaterial \"b\" \"string type\" "
                                            "\"conductor\"\nMaterial \"mix\" \"string materials\" [\"a\" \"b\"]\n"
                                            "Shape \"sphere\"\n"));
  ASSERT_EQ(one.materials.size(), 3u);
  EXPECT_FALSE(one.materials[0].normal_texture.used());
  EXPECT_TRUE(one.materials[1].normal_texture.used());
  EXPECT_FALSE(one.materials[2].normal_texture.used());
}

TEST(PbrtLook, MediaOfMixturesBelongToTheirGlass) {
  const Scene scene = load(
      "WorldBegin\nMakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 2 4] \"rgb sigma_s\" [0 0 "
      "0]\n"
      "MakeNamedMaterial \"a\" \"string type\" \"dielectric\"\nMakeNamedMaterial \"b\" \"string type\" \"diffuse\"\n"
      "MediumInterface \"m\" \"\"\nMaterial \"mix\" \"string materials\" [\"a\" \"b\"]\nShape \"sphere\"\n");
  EXPECT_FALSE(mentions(scene.warnings, "media"));
  EXPECT_TRUE(is_finite(scene.materials.at(1).attenuation_distance));
  EXPECT_FALSE(is_finite(scene.materials.at(2).attenuation_distance));
}

TEST(PbrtLook, ACoinChoosesPartsOfMixtures) {
  const std::string text =
      "WorldBegin\nMakeNamedMaterial \"a\" \"string type\" \"diffuse\"\n"
      "MakeNamedMaterial \"b\" \"string type\" \"conductor\" \"rgb reflectance\" [0.8 0.4 0.2]\n"
      "MakeNamedMaterial \"c\" \"string type\" \"mix\" \"string materials\" [\"b\" \"a\"] \"float amount\" 0.25\n"
      "Texture \"t\" \"float\" \"checkerboard\" \"float tex1\" 0 \"float tex2\" 0.5\n"
      "Material \"mix\" \"string materials\" [\"a\" \"c\"] \"texture amount\" \"t\"\nShape \"sphere\"\n";
  const Scene scene = load(text);
  ASSERT_EQ(scene.materials.size(), 4u);  // mix, a, c, b
  const auto at = [&](Index i) { return scene.materials.at(static_cast<size_t>(i)); };
  const Material& mix = scene.materials[0];
  EXPECT_TRUE(mix.mix_texture.used());
  EXPECT_FLOAT_EQ(mix.mix_share, 1);
  EXPECT_EQ(at(mix.mix_first).name, "a");
  const Material& inner = at(mix.mix_second);
  EXPECT_EQ(inner.name, "c");
  EXPECT_FLOAT_EQ(inner.mix_share, 0.25f);
  EXPECT_EQ(at(inner.mix_first).name, "b");
  EXPECT_EQ(inner.mix_second, mix.mix_first);  // read once
}

TEST(PbrtLook, MixedMetalsCoverTheirBase) {
  const Material m = material(
      "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"rgb reflectance\" [0.5 0.5 0.5]\n"
      "MakeNamedMaterial \"b\" \"string type\" \"conductor\" \"rgb reflectance\" [0.8 0.4 0.2]\n"
      "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" 0.5");
  const float f0 = std::pow((m.ior - 1) / (m.ior + 1), 2);
  const Rgb layer = m.specular_color * m.specular * f0;
  expect_near(layer, {0.4f, 0.2f, 0.1f}, 3e-3f);
  expect_near(m.base_color * (Rgb(1) - layer), Rgb(0.25f), 2e-3f);
}

TEST(PbrtLook, MixedCoatsKeepTheirReflection) {
  const std::string parts =
      "WorldBegin\nMakeNamedMaterial \"a\" \"string type\" \"coateddiffuse\" \"rgb reflectance\" [0 0 0]\n"
      "MakeNamedMaterial \"b\" \"string type\" \"conductor\" \"rgb reflectance\" [0.8 0.4 0.2]\n"
      "Texture \"t\" \"float\" \"checkerboard\" \"float tex1\" 0 \"float tex2\" 0.5\n";
  const auto reflected = [](const Material& m) {
    return m.specular_color * m.specular * sqr((m.ior - 1) / (m.ior + 1));
  };
  const std::string mix = "Material \"mix\" \"string materials\" [\"a\" \"b\"] ";
  const Scene half = load(parts + mix + "\"float amount\" 0.5\nShape \"sphere\"\n");
  expect_near(reflected(half.materials.at(0)), Rgb(0.42f, 0.22f, 0.12f), 3e-3f);  // half of F0 and of 0.04
  EXPECT_FLOAT_EQ(half.materials[0].specular, 1);                                 // at grazing angles
  // Where the texture is 0, the coat alone.
  const Scene textured = load(parts + mix + "\"texture amount\" \"t\"\nShape \"sphere\"\n");
  const Material& m = textured.materials.at(0);
  const Texture& tint = textured.textures.at(static_cast<size_t>(m.specular_color_texture.texture));
  float least = 1;
  for (size_t i = 0; i < tint.texels.size(); i += 4)
    least = std::min(least, linear_from_srgb(static_cast<float>(std::to_integer<int>(tint.texels[i])) / 255));
  EXPECT_NEAR(reflected(m).r * least, 0.04f, 2e-3f);
}

TEST(PbrtLook, TexturesAreBaked) {
  const SceneFolder folder;
  folder.write("t.png", testing::png(2, 1, {255, 0, 0, 255, 0, 128, 0, 255}));
  const Scene scene = load_scene(folder.write(
      "a.pbrt",
      "WorldBegin\nTexture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"t.png\" \"float uscale\" 2 \"float "
      "vscale\" 3 \"float vdelta\" 0.5 \"string wrap\" \"clamp\"\n"
      "Texture \"half\" \"spectrum\" \"scale\" \"texture tex\" \"t\" \"float scale\" 0.5\n"
      "Material \"diffuse\" \"texture reflectance\" \"t\"\nShape \"sphere\"\n"
      "Material \"coateddiffuse\" \"texture reflectance\" \"half\" \"float eta\" 1\nShape \"sphere\"\n"));
  const Material& plain = scene.materials.at(0);
  const Texture& texture = scene.textures.at(static_cast<size_t>(plain.base_color_texture.texture));
  EXPECT_EQ(texture.texels[0], std::byte{255});
  EXPECT_EQ(texture.texels[5], std::byte{128});
  EXPECT_TRUE(texture.file);
  EXPECT_EQ(texture.wrap_u, WrapMode::clamp);
  // (s, t) = (2 u, 3 v + 0.5), and relume's v' = 1 - t with v = 1 - v_relume.
  EXPECT_EQ(plain.base_color_texture.scale, Vec2(2, 3));
  EXPECT_EQ(plain.base_color_texture.offset, Vec2(0, -2.5f));
  const Texture& half = scene.textures.at(static_cast<size_t>(scene.materials.at(1).base_color_texture.texture));
  EXPECT_EQ(half.texels[0], std::byte{quantise_unorm8(srgb_from_linear(0.5f))});
  EXPECT_TRUE(scene.warnings.size() <= 1) << scene.warnings[0];
}

TEST(PbrtLook, OnlyPngHasAnEncoding) {
  const SceneFolder folder;
  Image grey(2, 2);
  for (Rgb& pixel : grey.pixels) pixel = Rgb(0.2f);
  write_image(folder.path() / "t.png", grey);
  folder.write("t.tga", std::string("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x18\x20\x7c\x7c\x7c", 21));
  const auto color = [&](const std::string& file) {
    const Scene scene = load_scene(folder.write(
        "a.pbrt",
        "WorldBegin Texture \"t\" \"spectrum\" \"imagemap\" \"string encoding\" \"linear\" \"string filename\" \"" +
            file + "\"\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\nShape \"sphere\"\n"));
    const Material& m = scene.materials.at(0);
    return m.base_color_texture.used()
               ? linear_from_srgb(static_cast<float>(std::to_integer<int>(scene.textures.at(0).texels[0])) / 255)
               : m.base_color.r;
  };
  EXPECT_NEAR(color("t.png"), srgb_from_linear(0.2f), 4e-3f);  // the codes are values
  EXPECT_NEAR(color("t.tga"), linear_from_srgb(124 / 255.0f), 4e-3f);
}

TEST(PbrtLook, CheckerboardsRepeatEveryTwoCells) {
  const Scene scene = load(
      "WorldBegin\nTexture \"c\" \"spectrum\" \"checkerboard\" \"float uscale\" 8 \"float vscale\" 6 \"rgb tex1\" [1 1 "
      "1] \"rgb tex2\" [0 0 0]\nMaterial \"diffuse\" \"texture reflectance\" \"c\"\nShape \"sphere\"\n");
  const Material& m = scene.materials.at(0);
  const Texture& t = scene.textures.at(0);
  ASSERT_EQ(t.width * t.height, 4);
  EXPECT_EQ(m.base_color_texture.scale, Vec2(4, 3));
  // The cell at u, v = 0 is tex1; it is the lower left texel.
  EXPECT_EQ(t.texels[8], std::byte{255});
  EXPECT_EQ(t.texels[0], std::byte{0});
  EXPECT_EQ(t.filter, FilterMode::nearest);
}

TEST(PbrtLook, AlphaCutsHoles) {
  const Scene scene = load("WorldBegin\nShape \"sphere\" \"float alpha\" 0.25\nShape \"sphere\"\n");
  EXPECT_EQ(scene.materials.at(0).alpha, 0.25f);
  EXPECT_EQ(scene.materials.at(0).alpha_mode, AlphaMode::blend);
  EXPECT_EQ(scene.materials.at(1).alpha_mode, AlphaMode::opaque);
}

TEST(PbrtLook, LightsAreNormalisedAsInPbrt) {
  const Scene scene = load(
      "WorldBegin\nLightSource \"point\" \"rgb I\" [1 2 3] \"float scale\" 2 \"point3 from\" [1 2 3]\n"
      "LightSource \"distant\" \"blackbody L\" 6500 \"float illuminance\" 10 \"point3 from\" [0 1 0] \"point3 to\" [0 "
      "0 "
      "0]\nLightSource \"point\" \"float power\" 100\n"
      "LightSource \"spot\" \"float coneangle\" 60 \"float conedeltaangle\" 30\n"
      "LightSource \"infinite\" \"spectrum L\" [300 7 900 7] \"float scale\" 3\n");
  EXPECT_EQ(scene.lights.at(0).intensity, Rgb(2, 4, 6));
  expect_near(scene.lights[1].intensity, Rgb(1.0432f, 0.9836f, 1.0352f) * 10.0f, 0.05f);
  const Vec3 down = Vec3(world_matrices(scene, 0)[1] * Vec4(0, 0, -1, 0));
  EXPECT_NEAR(glm::distance(down, Vec3(0, -1, 0)), 0, 1e-5);
  EXPECT_NEAR(scene.lights[2].intensity.g, 100 / (4 * M_PI), 1e-4);
  // Integrals of both falloffs over the cosine: pbrt's smooth step from cos 60° to cos 30°, relume's square.
  const PunctualLight& spot = scene.lights[3];
  const double inner = std::cos(static_cast<double>(spot.inner_cone_rad)), outer = 0.5;
  EXPECT_NEAR(1 - inner + (inner - outer) / 3, 1 - (std::sqrt(3.0) / 2 + 0.5) / 2, 1e-5);
  // Equal energy has the luminance 1, and its own colour.
  EXPECT_EQ(scene.environment.kind, EnvironmentKind::constant);
  EXPECT_NEAR(glm::dot(scene.environment.color, Rgb(0.2126f, 0.7152f, 0.0722f)), 3, 0.01f);
}

TEST(PbrtLook, AreaLightsEmit) {
  const Scene scene = load(
      "WorldBegin\nAreaLightSource \"diffuse\" \"rgb L\" [1 2 3] \"float scale\" 2 \"bool twosided\" true\nShape "
      "\"sphere\"\nAreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"float power\" 5\nShape \"disk\" \"float radius\" "
      "2\n");
  EXPECT_EQ(scene.materials.at(0).emission, Rgb(2, 4, 6));
  EXPECT_TRUE(scene.materials[0].double_sided);
  EXPECT_FALSE(scene.materials.at(1).double_sided);
  EXPECT_NEAR(scene.materials[1].emission.g, 5 / (M_PI * 4 * M_PI), 1e-3);  // Φ = π A L
}

TEST(PbrtLook, EachPartOfAnAreaLightHasItsPower) {
  const std::string light = "AreaLightSource \"diffuse\" \"rgb L\" [1 1 1] \"float power\" 5\n";
  const std::string quad = "\"point3 P\" [0 0 0 2 0 0 0 2 0 2 2 0]";
  const Scene scene = load("WorldBegin\n" + light + "Shape \"bilinearmesh\" " + quad + "\n" + light +
                           "Shape \"trianglemesh\" \"integer indices\" [0 1 2 1 3 2] " + quad + "\n" + light +
                           "Shape \"sphere\" \"float radius\" 2\nScale 3 3 3\nShape \"sphere\" \"float radius\" 2\n");
  EXPECT_NEAR(scene.materials.at(0).emission.g, 5 / (M_PI * 4), 1e-4);
  EXPECT_NEAR(scene.materials.at(1).emission.g, 5 / (M_PI * 2), 1e-4);  // of each triangle
  ASSERT_EQ(scene.meshes.size(), 4u);
  const auto radiance = [&](size_t mesh) {
    return scene.materials.at(static_cast<size_t>(scene.meshes[mesh].material)).emission.g;
  };
  EXPECT_NEAR(radiance(2), 5 / (M_PI * 16 * M_PI), 1e-4);
  EXPECT_NEAR(radiance(3), 5 / (M_PI * 144 * M_PI), 1e-5);
}

TEST(PbrtLook, MapsHaveTheirIlluminance) {
  // pbrt finds 2π · mean over the sphere of L cos θ of the upper half: π / 2 for L = 1.
  const SceneFolder folder;
  Image white(32, 32);
  for (Rgb& pixel : white.pixels) pixel = Rgb(1);
  write_image(folder.path() / "env.exr", white);
  const Scene scene = load_scene(folder.write("a.pbrt",
                                              "WorldBegin\nLightSource \"infinite\" \"string filename\" \"env.exr\" "
                                              "\"float illuminance\" 10\nShape \"sphere\"\n"));
  EXPECT_NEAR(scene.environment.map.at(0).g, 10 / (M_PI / 2), 0.05);
}

TEST(PbrtLook, EqualAreaMapIsItsInverse) {
  for (int i = 0; i < 400; ++i) {
    const Vec2 p((static_cast<float>(i % 20) + 0.37f) / 20, (static_cast<float>(i / 20) + 0.61f) / 20);
    const Vec3 d = pbrt::direction_of_square(p);
    EXPECT_NEAR(glm::length(d), 1, 1e-5);
    EXPECT_NEAR(glm::distance(pbrt::square_of_direction(d), p), 0, 1e-4) << p.x << " " << p.y;
  }
  EXPECT_NEAR(glm::distance(pbrt::direction_of_square({0.5f, 0.5f}), Vec3(0, 0, 1)), 0, 1e-6);
  EXPECT_NEAR(glm::distance(pbrt::direction_of_square({1, 0.5f}), Vec3(1, 0, 0)), 0, 1e-3);
  EXPECT_NEAR(glm::distance(pbrt::direction_of_square({0.5f, 1}), Vec3(0, 1, 0)), 0, 1e-3);
}

/// Radiance of the map in a direction.
Rgb radiance(const Environment& e, const Vec3& d) {
  const float column = std::atan2(d.x, -d.z) / (2 * kPi) + 0.5f;
  const float row = std::acos(std::clamp(d.y, -1.0f, 1.0f)) / kPi;
  const auto at = [](float share, int count) {
    return std::clamp(static_cast<int>(share * static_cast<float>(count)), 0, count - 1);
  };
  return e.map[static_cast<size_t>(at(row, e.height) * e.width + at(column, e.width))];
}

TEST(PbrtLook, EnvironmentMapsKeepTheirDirections) {
  // A smooth map: the colour is the direction.
  Image image(64, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const Vec2 p((static_cast<float>(x) + 0.5f) / 64, (static_cast<float>(y) + 0.5f) / 64);
      image.at(x, y) = pbrt::direction_of_square(p) + 2.0f;
    }
  }
  const SceneFolder folder;
  write_image(folder.path() / "env.exr", image);
  for (const char* camera : {"LookAt 0 0 0 0 1 0 0 0 1", "Scale -1 1 1 LookAt 0 0 0 0 1 0 0 0 1", ""}) {
    const Scene scene = load_scene(folder.write(
        "a.pbrt", std::string(camera) +
                      "\nCamera \"perspective\"\nWorldBegin\nAttributeBegin Rotate 90 0 0 1 LightSource \"infinite\" "
                      "\"string filename\" \"env.exr\" \"float scale\" 3 AttributeEnd\nShape \"sphere\"\n"));
    ASSERT_EQ(scene.environment.kind, EnvironmentKind::map);
    const Mat4 to_relume = scene.nodes[0].meshes.empty() ? world_matrices(scene, 0)[0] : Mat4(1);
    for (const Vec3& d : {Vec3(0.6f, 0, 0.8f), Vec3(0, 0.6f, -0.8f), Vec3(-0.48f, 0.6f, 0.64f)}) {
      // Rotate 90° about z takes x to y.
      const Vec3 world(-d.y, d.x, d.z);
      expect_near(radiance(scene.environment, Vec3(to_relume * Vec4(world, 0))) / 3.0f - 2.0f, d, 0.06f);
    }
  }
}

}  // namespace
}  // namespace relume
