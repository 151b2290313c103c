// Tests material layers beyond core glTF, conversions and variants.
#include <gtest/gtest.h>

#include "relume/scene_io.h"
#include "scene_io/testing/scene_files.h"
#include "scene_io/testing/written_gltf.h"

namespace relume {
namespace {

using testing::data_uri;
using testing::error_of;
using testing::GltfBuilder;
using testing::json;
using testing::mentions;
using testing::SceneFolder;
using testing::solid_png;

int add_texture(GltfBuilder& file, uint8_t red, uint8_t alpha = 40) {
  const int image = file.add("images", {{"uri", data_uri(solid_png(2, 2, red, 20, 30, alpha))}});
  return file.add("textures", {{"source", image}});
}

json layers() {
  return {{"KHR_materials_clearcoat",
           {{"clearcoatFactor", 1}, {"clearcoatNormalTexture", {{"index", 0}, {"texCoord", 1}, {"scale", 0.5}}}}},
          {"KHR_materials_anisotropy",
           {{"anisotropyStrength", 0.6}, {"anisotropyRotation", 1.5}, {"anisotropyTexture", {{"index", 1}}}}},
          {"KHR_materials_sheen",
           {{"sheenColorFactor", {0.9, 0.5, 0.25}},
            {"sheenColorTexture", {{"index", 2}}},
            {"sheenRoughnessFactor", 0.75},
            {"sheenRoughnessTexture", {{"index", 3}}}}},
          {"KHR_materials_iridescence",
           {{"iridescenceFactor", 0.5},
            {"iridescenceTexture", {{"index", 4}}},
            {"iridescenceIor", 1.8},
            {"iridescenceThicknessMinimum", 200},
            {"iridescenceThicknessMaximum", 600},
            {"iridescenceThicknessTexture", {{"index", 5}}}}},
          {"KHR_materials_diffuse_transmission",
           {{"diffuseTransmissionFactor", 0.25},
            {"diffuseTransmissionTexture", {{"index", 6}}},
            {"diffuseTransmissionColorFactor", {0.5, 1, 0.5}},
            {"diffuseTransmissionColorTexture", {{"index", 7}}}}}};
}

void expect_layers(const Scene& scene) {
  const Material& m = scene.materials.at(0);
  EXPECT_EQ(m.clearcoat_normal_scale, 0.5f);
  EXPECT_EQ(m.clearcoat_normal_texture.uv_set, 1);
  EXPECT_EQ(m.anisotropy, 0.6f);
  EXPECT_EQ(m.anisotropy_rotation_rad, 1.5f);
  EXPECT_EQ(m.sheen_color, Rgb(0.9f, 0.5f, 0.25f));
  EXPECT_EQ(m.sheen_roughness, 0.75f);
  EXPECT_EQ(m.iridescence, 0.5f);
  EXPECT_EQ(m.iridescence_ior, 1.8f);
  EXPECT_EQ(m.iridescence_thickness_min_nm, 200.0f);
  EXPECT_EQ(m.iridescence_thickness_nm, 600.0f);
  EXPECT_EQ(m.diffuse_transmission, 0.25f);
  EXPECT_EQ(m.diffuse_transmission_color, Rgb(0.5f, 1, 0.5f));
  const auto expect_texture = [&](const TextureRef& ref, int red, PixelFormat format) {
    ASSERT_TRUE(ref.used()) << red;
    const Texture& texture = scene.textures.at(static_cast<size_t>(ref.texture));
    EXPECT_EQ(texture.format, format) << red;
    EXPECT_EQ(std::to_integer<int>(texture.texels[0]), red);
  };
  expect_texture(m.clearcoat_normal_texture, 0, PixelFormat::rgba8_linear);
  expect_texture(m.anisotropy_texture, 1, PixelFormat::rgba8_linear);
  expect_texture(m.sheen_color_texture, 2, PixelFormat::rgba8_srgb);
  expect_texture(m.sheen_roughness_texture, 3, PixelFormat::rgba8_linear);
  expect_texture(m.iridescence_texture, 4, PixelFormat::rgba8_linear);
  expect_texture(m.iridescence_thickness_texture, 5, PixelFormat::rgba8_linear);
  expect_texture(m.diffuse_transmission_texture, 6, PixelFormat::rgba8_linear);
  expect_texture(m.diffuse_transmission_color_texture, 7, PixelFormat::rgba8_srgb);
}

TEST(GltfLayers, AreReadAndWritten) {
  GltfBuilder file;
  for (uint8_t i = 0; i < 8; ++i) add_texture(file, i);
  file.add_triangle_with_material({{"extensions", layers()}});
  const Scene scene = file.load();
  EXPECT_EQ(scene.warnings.size(), 1u);
  EXPECT_TRUE(mentions(scene.warnings, "neither tangents nor texture coordinates 0"));
  expect_layers(scene);
  const SceneFolder folder;
  EXPECT_TRUE(write_gltf(folder.path() / "a.glb", scene).empty());
  expect_layers(load_scene(folder.path() / "a.glb"));
}

TEST(GltfLayers, HaveDefaults) {
  GltfBuilder file;
  file.add_triangle_with_material({{"extensions",
                                    {{"KHR_materials_anisotropy", json::object()},
                                     {"KHR_materials_sheen", json::object()},
                                     {"KHR_materials_iridescence", json::object()},
                                     {"KHR_materials_diffuse_transmission", json::object()}}}});
  const Material m = file.load().materials[0];
  EXPECT_EQ(m.anisotropy, 0.0f);
  EXPECT_EQ(m.sheen_color, Rgb(0));
  EXPECT_EQ(m.iridescence, 0.0f);
  EXPECT_EQ(m.iridescence_ior, 1.3f);
  EXPECT_EQ(m.iridescence_thickness_min_nm, 100.0f);
  EXPECT_EQ(m.iridescence_thickness_nm, 400.0f);
  EXPECT_EQ(m.diffuse_transmission_color, Rgb(1));
}

json specular_glossiness(const json& members) {
  return {{"extensions", {{"KHR_materials_pbrSpecularGlossiness", members}}}};
}

TEST(GltfLayers, ConvertSpecularGlossiness) {
  GltfBuilder file;
  file.add_triangle_with_material(specular_glossiness(
      {{"diffuseFactor", {0.5, 0.25, 1, 0.75}}, {"specularFactor", {0.04, 0.2, 0.5}}, {"glossinessFactor", 0.7}}));
  const Scene scene = file.load();
  const Material& m = scene.materials[0];
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_EQ(m.metallic, 0.0f);
  EXPECT_NEAR(m.roughness, 0.3f, 1e-6f);
  EXPECT_EQ(m.alpha, 0.75f);
  EXPECT_LT(glm::distance(m.base_color, Rgb(0.5f, 0.25f, 1)), 1e-6f);
  const float f0 = 0.04f;  // for an index of refraction of 1.5
  EXPECT_EQ(m.ior, 1.5f);
  EXPECT_LT(glm::distance(f0 * m.specular_color, Rgb(0.04f, 0.2f, 0.5f)), 1e-6f);
}

TEST(GltfLayers, ConvertTexturesOfSpecularGlossiness) {
  GltfBuilder file;
  const int texture = add_texture(file, 9, 51);  // alpha 0.2
  for (const double glossiness : {1.0, 0.5}) {
    file.add_triangle_with_material(
        specular_glossiness({{"specularGlossinessTexture", {{"index", texture}}}, {"glossinessFactor", glossiness}}));
  }
  const Scene scene = file.load();
  for (size_t i = 0; i < 2; ++i) {
    const Material& m = scene.materials[i];
    EXPECT_EQ(m.roughness, 1.0f);
    const Texture& roughness = scene.textures.at(static_cast<size_t>(m.metallic_roughness_texture.texture));
    EXPECT_EQ(std::to_integer<int>(roughness.texels[1]), i == 0 ? 204 : 230);  // 0.8 and 0.9
    const Texture& specular = scene.textures.at(static_cast<size_t>(m.specular_color_texture.texture));
    EXPECT_EQ(specular.format, PixelFormat::rgba8_srgb);
    EXPECT_EQ(std::to_integer<int>(specular.texels[0]), 9);
  }
}

TEST(GltfLayers, ConvertSpecularGlossinessEquallyWithAndWithoutTextures) {
  GltfBuilder file;
  const int white = add_texture(file, 255, 255);
  json members = {{"diffuseFactor", {0.5, 0.25, 1, 1}}, {"specularFactor", {0.1, 0.2, 0.5}}, {"glossinessFactor", 0.7}};
  file.add_triangle_with_material(specular_glossiness(members));
  members["specularGlossinessTexture"] = {{"index", white}};
  file.add_triangle_with_material(specular_glossiness(members));
  const Scene scene = file.load();
  EXPECT_EQ(scene.materials[0].base_color, scene.materials[1].base_color);
  EXPECT_EQ(scene.materials[0].specular_color, scene.materials[1].specular_color);
  const Texture& roughness =
      scene.textures.at(static_cast<size_t>(scene.materials[1].metallic_roughness_texture.texture));
  EXPECT_NEAR(std::to_integer<int>(roughness.texels[1]) / 255.0, scene.materials[0].roughness, 1.0 / 255);
}

/// A red triangle, green or blue in variants.
GltfBuilder painted() {
  GltfBuilder file;
  for (const json& color : {json{1, 0, 0, 1}, json{0, 1, 0, 1}, json{0, 0, 1, 1}})
    file.add("materials", {{"pbrMetallicRoughness", {{"baseColorFactor", color}}}});
  file.doc["extensions"]["KHR_materials_variants"]["variants"] = {
      {{"name", "meadow"}}, {{"name", "sea"}}, {{"name", "lawn"}}};
  const json mappings = {{{"material", 1}, {"variants", {0, 2}}}, {{"material", 2}, {"variants", {1}}}};
  file.add_root(
      {{"mesh",
        file.add_triangle({{"material", 0}, {"extensions", {{"KHR_materials_variants", {{"mappings", mappings}}}}}})}});
  return file;
}

Rgb color_of(const Scene& scene) {
  return scene.materials.at(static_cast<size_t>(scene.meshes.at(0).material)).base_color;
}

TEST(GltfVariants, ReplaceMaterials) {
  Scene scene = painted().load();
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_EQ(scene.variants, (std::vector<std::string>{"meadow", "sea", "lawn"}));
  EXPECT_EQ(color_of(scene), Rgb(1, 0, 0));
  choose_variant(scene, "sea");
  EXPECT_EQ(color_of(scene), Rgb(0, 0, 1));
  choose_variant(scene, "lawn");
  EXPECT_EQ(color_of(scene), Rgb(0, 1, 0));
  EXPECT_NE(error_of([&] { choose_variant(scene, "city"); }).find("one of 'meadow', 'sea', 'lawn'"), std::string::npos);
  Scene plain;
  EXPECT_NE(error_of([&] { choose_variant(plain, "city"); }).find("the scene has no variants"), std::string::npos);
}

TEST(GltfVariants, KeepTheDefaultMaterial) {
  GltfBuilder file = painted();
  json& mappings = file.doc["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"];
  mappings = {{{"material", 1}, {"variants", {0}}}};
  Scene scene = file.load();
  choose_variant(scene, "meadow");
  EXPECT_EQ(color_of(scene), Rgb(0, 1, 0));
  const SceneFolder folder;
  write_gltf(folder.path() / "a.gltf", scene);
  EXPECT_EQ(color_of(load_scene(folder.path() / "a.gltf")), Rgb(1, 0, 0));
  choose_variant(scene, "sea");  // has no material for this triangle
  EXPECT_EQ(color_of(scene), Rgb(1, 0, 0));
  choose_variant(scene, "meadow");
  choose_variant(scene, "");
  EXPECT_EQ(color_of(scene), Rgb(1, 0, 0));
}

TEST(GltfVariants, AreWritten) {
  const SceneFolder folder;
  write_gltf(folder.path() / "a.gltf", painted().load());
  Scene again = load_scene(folder.path() / "a.gltf");
  EXPECT_TRUE(again.warnings.empty());
  choose_variant(again, "sea");
  EXPECT_EQ(color_of(again), Rgb(0, 0, 1));
}

TEST(GltfVariants, MissingVariantsAreOmitted) {
  GltfBuilder file = painted();
  json& mappings = file.doc["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"];
  mappings.push_back({{"material", 0}, {"variants", {7, -1, "sea"}}});
  mappings.push_back({{"material", 50}, {"variants", {0}}});
  mappings.push_back({{"material", 0}});
  mappings.push_back(5);
  const Scene scene = file.load();
  EXPECT_EQ(scene.meshes[0].variants.size(), 3u);
  EXPECT_TRUE(mentions(scene.warnings, "for variant 7, but the file has 3"));
  EXPECT_TRUE(mentions(scene.warnings, "variants with material 50, which does not exist"));
}

TEST(GltfPrimitives, PointsAndLinesAreSkippedWithOneNote) {
  GltfBuilder file;
  file.add_root({{"mesh", file.add_triangle()}});
  for (const int mode : {0, 1, 3}) file.add_root({{"mesh", file.add_triangle({{"mode", mode}})}});
  const Scene scene = file.load();
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_TRUE(mentions(scene.warnings, "points and lines are skipped (3 primitives)"));
  EXPECT_EQ(scene.meshes.size(), 1u);
}

}  // namespace
}  // namespace relume
