// Tests that exports keep the original image files of unchanged textures.
#include <gtest/gtest.h>

#include "files/atomic_file.h"
#include "files/testing/temp_folder.h"
#include "image/ktx2/testing/ktx2_file.h"
#include "image/testing/png.h"
#include "image/testing/webp.h"
#include "relume/image_io.h"
#include "relume/scene_io.h"
#include "render/session.h"
#include "scene/material_parameters.h"
#include "scene_io/testing/scene_files.h"
#include "scene_io/testing/written_gltf.h"

namespace relume {
namespace {

using testing::data_uri;
using testing::GltfBuilder;
using testing::json;
using testing::written_json;

Bytes jpeg(const TempFolder& folder) {
  Image image(8, 8);
  for (int i = 0; i < 64; ++i) image.at(i % 8, i / 8) = Rgb(0.1f, static_cast<float>(i) / 64, 0.5f);
  write_image(folder / "a.jpg", image);
  return read_file(folder / "a.jpg");
}

/// Base colour, metallic-roughness, normal and emission as JPEG, WebP, 16-bit PNG and KTX2.
GltfBuilder textured_file(const TempFolder& folder) {
  const std::vector<uint8_t> samples = {0x80, 0x01, 0x7f, 0x40, 0xff, 0xff, 0xff, 0xff};
  GltfBuilder file;
  for (const Bytes& image : {jpeg(folder), testing::make_webp(2, 1, {0, 90, 200, 255, 0, 250, 30, 255}),
                             testing::make_png(1, 1, 16, testing::kRgba, samples), testing::uastc_ktx2().bytes()})
    file.add("images", {{"uri", data_uri(image)}});
  file.add("textures", {{"source", 0}});
  file.add("textures", {{"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}});
  file.add("textures", {{"source", 2}});
  file.add("textures", {{"extensions", {{"KHR_texture_basisu", {{"source", 3}}}}}});
  const int uv = file.floats({0, 0, 1, 0, 0, 1}, 2);
  const int material = file.add(
      "materials",
      {{"name", "all"},
       {"pbrMetallicRoughness",
        {{"baseColorTexture", {{"index", 0}}}, {"metallicRoughnessTexture", {{"index", 1}}}, {"roughnessFactor", 0.7}}},
       {"normalTexture", {{"index", 2}, {"scale", 0.5}}},
       {"emissiveTexture", {{"index", 3}}},
       {"emissiveFactor", {0.5, 0.25, 1}},
       {"doubleSided", true},
       {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0.3}}}, {"KHR_materials_ior", {{"ior", 1.4}}}}}});
  file.add_root({{"mesh", file.add_triangle({{"material", material}, {"attributes", {{"TEXCOORD_0", uv}}}})}});
  return file;
}

Image render_image(Scene scene) {
  RenderSettings settings;
  settings.width = settings.height = 24;
  settings.threads = 1;
  Session session(std::move(scene), settings);
  for (int i = 0; i < 4; ++i) session.render_frame();
  return session.image();
}

TEST(GltfKeptImages, LoadedAndExportedScenesLookTheSame) {
  const TempFolder folder;
  const Scene before = textured_file(folder).load();
  ASSERT_TRUE(before.warnings.empty()) << before.warnings.front();
  const Image expected = render_image(before);
  for (const char* name : {"b.glb", "b.gltf"}) {
    EXPECT_EQ(write_gltf(folder / name, before).size(), 1u) << "nothing is lost or converted";
    const Scene after = load_scene(folder / name);
    EXPECT_TRUE(after.warnings.empty());
    ASSERT_EQ(after.textures.size(), before.textures.size());
    for (size_t i = 0; i < before.textures.size(); ++i) {
      EXPECT_EQ(*after.textures[i].file, *before.textures[i].file) << name << " " << i;
      EXPECT_EQ(after.textures[i].texels, before.textures[i].texels) << name << " " << i;
    }
    const Material& material = before.materials[0];
    for_each_parameter(after.materials[0], [&](const MaterialParameter& p, const auto& value) {
      using T = std::remove_cvref_t<decltype(value)>;
      if constexpr (std::is_same_v<T, TextureRef>) {
        EXPECT_EQ(value.used(), (material.*std::get<T Material::*>(p.member)).used()) << p.name;
      } else {
        EXPECT_EQ(value, material.*std::get<T Material::*>(p.member)) << p.name;
      }
    });
    EXPECT_EQ(render_image(after).pixels, expected.pixels) << name;
  }
}

TEST(GltfKeptImages, FilesNameTheirFormatAndExtensions) {
  const TempFolder folder;
  write_gltf(folder / "b.gltf", textured_file(folder).load());
  const json gltf = written_json(folder / "b.gltf");
  std::vector<std::string> uris;
  for (const json& image : gltf["images"]) uris.push_back(image["uri"]);
  EXPECT_EQ(uris, (std::vector<std::string>{"b.texture0.jpg", "b.texture1.data.webp", "b.texture2.data.png",
                                            "b.texture3.ktx2"}));
  const json required = gltf["extensionsRequired"];
  EXPECT_EQ(required, json({"EXT_texture_webp", "KHR_texture_basisu"}));
  EXPECT_EQ(gltf["textures"][1]["extensions"]["EXT_texture_webp"]["source"], 1);
  EXPECT_FALSE(gltf["textures"][1].contains("source"));
}

TEST(GltfKeptImages, ExtensionsThatOtherProgramsNeedAreOneWarning) {
  const TempFolder folder;
  Scene scene = textured_file(folder).load();
  const std::vector<std::string> warnings = write_gltf(folder / "b.gltf", scene);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_NE(warnings[0].find("other programs need EXT_texture_webp and KHR_texture_basisu to open it"),
            std::string::npos)
      << warnings[0];
  for (const size_t i : {1u, 3u}) scene.textures[i].file = nullptr;
  EXPECT_TRUE(write_gltf(folder / "c.gltf", scene).empty()) << "they are PNGs";
}

TEST(GltfKeptImages, ChangedTexelsBecomeAPng) {
  const TempFolder folder;
  Scene scene = textured_file(folder).load();
  scene.textures[0].texels[0] ^= std::byte{1};
  write_gltf(folder / "b.gltf", scene);
  EXPECT_EQ(written_json(folder / "b.gltf")["images"][0]["uri"], "b.texture0.png");
  EXPECT_EQ(load_scene(folder / "b.gltf").textures[0].texels, scene.textures[0].texels);
}

TEST(GltfKeptImages, AForeignFileIsNotKept) {
  const TempFolder folder;
  Scene scene = textured_file(folder).load();
  scene.textures[0].file = std::make_shared<const Bytes>(100, std::byte{0x42});
  write_gltf(folder / "b.gltf", scene);
  EXPECT_EQ(written_json(folder / "b.gltf")["images"][0]["uri"], "b.texture0.png");
}

}  // namespace
}  // namespace relume
