#include <gtest/gtest.h>

#include "image/ktx2/testing/ktx2_file.h"
#include "relume/scene_io.h"
#include "scene_io/testing/scene_files.h"

namespace relume {
namespace {

using testing::data_uri;
using testing::GltfBuilder;
using testing::json;
using testing::mentions;
using testing::SceneFolder;
using testing::solid_png;

/// Adds a texture with a 2x2 image of this colour.
int add_texture(GltfBuilder& file, uint8_t red, int sampler = -1) {
  const int image = file.add("images", {{"uri", data_uri(solid_png(2, 2, red, 20, 30, 40))}});
  json texture = {{"source", image}};
  if (sampler >= 0) texture["sampler"] = sampler;
  return file.add("textures", texture);
}

TEST(GltfMaterial, ReadsCoreProperties) {
  GltfBuilder file;
  file.add_triangle_with_material(
      {{"name", "m"},
       {"pbrMetallicRoughness",
        {{"baseColorFactor", {0.1, 0.2, 0.3, 0.4}}, {"metallicFactor", 0.5}, {"roughnessFactor", 0.6}}},
       {"emissiveFactor", {1, 0.5, 0.25}},
       {"alphaMode", "MASK"},
       {"alphaCutoff", 0.7},
       {"doubleSided", true}});
  const Scene scene = file.load();
  ASSERT_EQ(scene.materials.size(), 1u);
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.name, "m");
  EXPECT_EQ(m.base_color, Rgb(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(m.alpha, 0.4f);
  EXPECT_EQ(m.metallic, 0.5f);
  EXPECT_EQ(m.roughness, 0.6f);
  EXPECT_EQ(m.emission, Rgb(1, 0.5f, 0.25f));
  EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
  EXPECT_EQ(m.alpha_cutoff, 0.7f);
  EXPECT_TRUE(m.double_sided);
  EXPECT_EQ(scene.meshes[0].material, 0);
}

TEST(GltfMaterial, ClampsVertexColors) {
  GltfBuilder file;
  file.add_root({{"mesh", file.add_triangle({{"attributes",
                                              {{"POSITION", file.floats({0, 0, 0, 1, 0, 0, 0, 1, 0}, 3)},
                                               {"COLOR_0", file.floats({3, 0.5f, 1, 0, -1, 0.25f, 1, 1, 1}, 3)}}}})}});
  const Scene scene = file.load();
  EXPECT_EQ(scene.meshes[0].colors, (std::vector<Vec4>{Vec4(1, 0.5f, 1, 1), Vec4(0, 0, 0.25f, 1), Vec4(1)}));
  EXPECT_TRUE(mentions(scene.warnings, "2 vertex colours outside [0, 1] are clamped"));
}

TEST(GltfMaterial, ReadsEveryExtension) {
  GltfBuilder file;
  file.add_triangle_with_material(
      {{"emissiveFactor", {1, 1, 0.5}},
       {"extensions",
        {{"KHR_materials_emissive_strength", {{"emissiveStrength", 60}}},
         {"KHR_materials_transmission", {{"transmissionFactor", 0.9}}},
         {"KHR_materials_volume",
          {{"thicknessFactor", 0.2}, {"attenuationColor", {0.5, 0.6, 0.7}}, {"attenuationDistance", 3}}},
         {"KHR_materials_ior", {{"ior", 1.33}}},
         {"KHR_materials_dispersion", {{"dispersion", 0.3}}},
         {"KHR_materials_specular", {{"specularFactor", 0.25}, {"specularColorFactor", {1, 2, 3}}}},
         {"KHR_materials_clearcoat", {{"clearcoatFactor", 0.8}, {"clearcoatRoughnessFactor", 0.1}}},
         {"KHR_materials_unlit", json::object()}}}});
  const Scene scene = file.load();
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.emission, Rgb(60, 60, 30));
  EXPECT_EQ(m.transmission, 0.9f);
  EXPECT_EQ(m.thickness, 0.2f);
  EXPECT_EQ(m.attenuation_color, Rgb(0.5f, 0.6f, 0.7f));
  EXPECT_EQ(m.attenuation_distance, 3.0f);
  EXPECT_EQ(m.ior, 1.33f);
  EXPECT_EQ(m.dispersion, 0.3f);
  EXPECT_EQ(m.specular, 0.25f);
  EXPECT_EQ(m.specular_color, Rgb(1, 2, 3));
  EXPECT_EQ(m.clearcoat, 0.8f);
  EXPECT_EQ(m.clearcoat_roughness, 0.1f);
  EXPECT_TRUE(m.unlit);
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(GltfMaterial, HasDefaults) {
  GltfBuilder file;
  file.add_triangle_with_material(json::object());
  const Scene scene = file.load();
  const Material& m = scene.materials[0];
  EXPECT_EQ(m.base_color, Rgb(1));
  EXPECT_EQ(m.metallic, 1.0f);
  EXPECT_EQ(m.roughness, 1.0f);
  EXPECT_EQ(m.emission, Rgb(0));
  EXPECT_EQ(m.ior, 1.5f);
  EXPECT_EQ(m.attenuation_distance, kInfinity);
  EXPECT_FALSE(m.base_color_texture.used());
}

TEST(GltfMaterial, LoadsAllTexturesWithTheirFormats) {
  GltfBuilder file;
  json refs;
  for (int i = 0; i < 9; ++i) refs.push_back({{"index", add_texture(file, static_cast<uint8_t>(i))}});
  file.add_triangle_with_material(
      {{"pbrMetallicRoughness", {{"baseColorTexture", refs[0]}, {"metallicRoughnessTexture", refs[1]}}},
       {"normalTexture", {{"index", 2}, {"scale", 0.5}}},
       {"emissiveTexture", refs[3]},
       {"extensions",
        {{"KHR_materials_specular", {{"specularTexture", refs[4]}, {"specularColorTexture", refs[5]}}},
         {"KHR_materials_transmission", {{"transmissionTexture", refs[6]}}},
         {"KHR_materials_clearcoat", {{"clearcoatTexture", refs[7]}, {"clearcoatRoughnessTexture", refs[8]}}}}}});
  const Scene scene = file.load();
  const Material& m = scene.materials[0];
  const auto check = [&](const TextureRef& ref, int red, PixelFormat format) {
    ASSERT_TRUE(ref.used());
    const Texture& texture = scene.textures[static_cast<size_t>(ref.texture)];
    EXPECT_EQ(texture.format, format) << red;
    EXPECT_EQ(texture.width, 2);
    EXPECT_EQ(std::to_integer<int>(texture.texels[0]), red);
    EXPECT_EQ(std::to_integer<int>(texture.texels[15]), 40);
  };
  check(m.base_color_texture, 0, PixelFormat::rgba8_srgb);
  check(m.metallic_roughness_texture, 1, PixelFormat::rgba8_linear);
  check(m.normal_texture, 2, PixelFormat::rgba8_linear);
  check(m.emission_texture, 3, PixelFormat::rgba8_srgb);
  check(m.specular_texture, 4, PixelFormat::rgba8_linear);
  check(m.specular_color_texture, 5, PixelFormat::rgba8_srgb);
  check(m.transmission_texture, 6, PixelFormat::rgba8_linear);
  check(m.clearcoat_texture, 7, PixelFormat::rgba8_linear);
  check(m.clearcoat_roughness_texture, 8, PixelFormat::rgba8_linear);
  EXPECT_EQ(m.normal_scale, 0.5f);
}

TEST(GltfMaterial, SplitsImagesUsedAsColourAndData) {
  GltfBuilder file;
  const int texture = add_texture(file, 7);
  const json ref = {{"index", texture}};
  file.add_triangle_with_material(
      {{"pbrMetallicRoughness", {{"baseColorTexture", ref}, {"metallicRoughnessTexture", ref}}},
       {"emissiveTexture", ref}});
  const Scene scene = file.load();
  ASSERT_EQ(scene.textures.size(), 2u);
  EXPECT_EQ(scene.materials[0].base_color_texture.texture, scene.materials[0].emission_texture.texture);
  EXPECT_NE(scene.materials[0].base_color_texture.texture, scene.materials[0].metallic_roughness_texture.texture);
}

TEST(GltfMaterial, ReadsSamplers) {
  GltfBuilder file;
  const int sampler = file.add("samplers", {{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}});
  const json ref = {{"index", add_texture(file, 7, sampler)}};
  file.add_triangle_with_material({{"pbrMetallicRoughness", {{"baseColorTexture", ref}}}});
  const Scene scene = file.load();
  EXPECT_EQ(scene.textures[0].wrap_u, WrapMode::clamp);
  EXPECT_EQ(scene.textures[0].wrap_v, WrapMode::mirror);
  EXPECT_EQ(scene.textures[0].filter, FilterMode::nearest);
}

TEST(GltfMaterial, ReadsTextureTransforms) {
  GltfBuilder file;
  const int texture = add_texture(file, 7);
  const json transform = {
      {"KHR_texture_transform", {{"offset", {0.1, 0.2}}, {"rotation", 0.3}, {"scale", {4, 5}}, {"texCoord", 1}}}};
  const json ref = {{"index", texture}, {"texCoord", 0}, {"extensions", transform}};
  file.add_triangle_with_material(
      {{"pbrMetallicRoughness", {{"baseColorTexture", ref}}},
       {"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 1}, {"transmissionTexture", ref}}}}},
       {"emissiveTexture", {{"index", texture}, {"texCoord", 5}}}});
  const Scene scene = file.load();
  for (const TextureRef* r : {&scene.materials[0].base_color_texture, &scene.materials[0].transmission_texture}) {
    EXPECT_EQ(r->offset, Vec2(0.1f, 0.2f));
    EXPECT_EQ(r->rotation_rad, 0.3f);
    EXPECT_EQ(r->scale, Vec2(4, 5));
    EXPECT_EQ(r->uv_set, 1);
  }
  EXPECT_EQ(scene.materials[0].emission_texture.uv_set, 0);
  EXPECT_TRUE(mentions(scene.warnings, "texture coordinate set 5"));
}

TEST(GltfMaterial, ReadsImagesFromBufferViews) {
  GltfBuilder file;
  const int view = file.add_view(solid_png(3, 1, 9, 8, 7, 6));
  file.add("images", {{"bufferView", view}, {"mimeType", "image/png"}});
  file.add("textures", {{"source", 0}});
  file.add_triangle_with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  const Scene scene = file.load();
  EXPECT_EQ(scene.textures[0].width, 3);
  EXPECT_TRUE(scene.warnings.empty());
}

/// In a buffer view, a data URI and a file; with an image for loaders without the extension, and without one.
TEST(GltfMaterial, ReadsBasisUniversalImages) {
  const Bytes ktx2 = testing::uastc_ktx2().bytes();
  const SceneFolder folder;
  folder.write("a.ktx2", ktx2);
  for (const bool is_required : {false, true}) {
    GltfBuilder file;
    file.doc["extensionsUsed"] = json::array({"KHR_texture_basisu"});
    if (is_required) file.doc["extensionsRequired"] = file.doc["extensionsUsed"];
    file.add("images", {{"bufferView", file.add_view(ktx2)}, {"mimeType", "image/ktx2"}});
    file.add("images", {{"uri", data_uri(ktx2)}});
    file.add("images", {{"uri", "a.ktx2"}});
    file.add("images", {{"uri", data_uri(solid_png(2, 2, 1, 2, 3, 4))}});
    for (int image = 0; image < 3; ++image) {
      json texture = {{"extensions", {{"KHR_texture_basisu", {{"source", image}}}}}};
      if (!is_required) texture["source"] = 3;
      file.add("textures", texture);
    }
    file.add_triangle_with_material(
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 1}}}}},
         {"emissiveTexture", {{"index", 2}}}});
    const Scene scene = load_scene(folder.write("a.gltf", file.text()));
    EXPECT_TRUE(scene.warnings.empty());
    ASSERT_EQ(scene.textures.size(), 3u);
    for (const Texture& texture : scene.textures) {
      EXPECT_EQ(texture.width, 8);
      EXPECT_EQ(texture.texels[0], std::byte{60});
    }
  }
}

TEST(GltfMaterial, ReplacesMissingAndBrokenTextures) {
  GltfBuilder file;
  file.add("images", {{"uri", "missing.png"}});
  file.add("images", {{"uri", "data:image/png;base64,AAAA"}});
  file.add("images", {{"bufferView", 99}});
  for (int i = 0; i < 4; ++i) file.add("textures", {{"source", i}});
  file.add_triangle_with_material(
      {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 1}}}}},
       {"normalTexture", {{"index", 2}}},
       {"emissiveTexture", {{"index", 3}}}});
  file.add_triangle_with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 50}}}}}});
  const Scene scene = file.load();
  ASSERT_EQ(scene.textures.size(), 4u);
  EXPECT_GE(scene.warnings.size(), 5u);
  const auto texel = [&](size_t i) { return std::to_integer<int>(scene.textures[i].texels[0]); };
  const size_t normal = static_cast<size_t>(scene.materials[0].normal_texture.texture);
  for (size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(scene.textures[i].width, 1);
    EXPECT_EQ(texel(i), i == normal ? 128 : 255);
  }
  EXPECT_FALSE(scene.materials[1].base_color_texture.used());
}

TEST(GltfMaterial, ClampsOutOfRangeNumbers) {
  GltfBuilder file;
  file.add_triangle_with_material(
      {{"pbrMetallicRoughness",
        {{"roughnessFactor", 7}, {"metallicFactor", -1}, {"baseColorFactor", {1e300, 0, 0, 1}}}},
       {"extensions", {{"KHR_materials_ior", {{"ior", 0.2}}}, {"KHR_materials_dispersion", {{"dispersion", -1}}}}}});
  file.add_triangle_with_material({{"extensions", {{"KHR_materials_dispersion", {{"dispersion", 21}}}}}});
  const Scene scene = file.load();
  EXPECT_EQ(scene.materials[0].roughness, 1.0f);
  EXPECT_EQ(scene.materials[0].metallic, 0.0f);
  EXPECT_EQ(scene.materials[0].base_color.r, 1.0f);
  EXPECT_EQ(scene.materials[0].ior, 1.0f);
  EXPECT_EQ(scene.materials[0].dispersion, 0.0f);
  EXPECT_EQ(scene.materials[1].dispersion, 20.0f);
  EXPECT_EQ(scene.warnings.size(), 6u);
}

}  // namespace
}  // namespace relume
