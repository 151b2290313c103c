// Tests which image of a glTF texture is read, and the parts of it that are kept.
#include <algorithm>

#include <gtest/gtest.h>

#include "image/ktx2/testing/ktx2_file.h"
#include "image/testing/webp.h"
#include "relume/image_io.h"
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

Bytes solid_webp(int width, int height, const std::vector<uint8_t>& rgba) {
  std::vector<uint8_t> pixels;
  for (int i = 0; i < width * height; ++i) pixels.insert(pixels.end(), rgba.begin(), rgba.end());
  return testing::make_webp(width, height, pixels);
}

/// Loads a file of one texture with these images. `extensions` refer to images by index; `source` is the fallback.
Scene load_texture(const std::vector<Bytes>& images, const json& extensions, int source) {
  GltfBuilder file;
  for (const Bytes& image : images) file.add("images", {{"uri", data_uri(image)}});
  json texture = {{"extensions", extensions}};
  if (source >= 0) texture["source"] = source;
  file.add("textures", texture);
  file.add_triangle_with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  return file.load();
}

const json kWebp = {{"EXT_texture_webp", {{"source", 0}}}};

TEST(GltfTexture, ReadsWebpImages) {
  const Bytes webp = solid_webp(3, 2, {10, 20, 30, 255});
  for (const int source : {-1, 1}) {
    const Scene scene = load_texture({webp, solid_png(1, 1, 9, 9, 9, 255)}, kWebp, source);
    EXPECT_TRUE(scene.warnings.empty());
    ASSERT_EQ(scene.textures.size(), 1u);
    EXPECT_EQ(scene.textures[0].width, 3);
    EXPECT_EQ(scene.textures[0].height, 2);
    EXPECT_EQ(scene.textures[0].texels[1], std::byte{20});
  }
}

TEST(GltfTexture, FilesMayRequireWebp) {
  GltfBuilder file;
  file.doc["extensionsUsed"] = file.doc["extensionsRequired"] = json::array({"EXT_texture_webp"});
  file.add_triangle();
  EXPECT_NO_THROW(file.load());
}

TEST(GltfTexture, UnreadableImagesOfExtensionsFallBackToTheSource) {
  Bytes cut_ktx2 = testing::uastc_ktx2().bytes();
  cut_ktx2.resize(cut_ktx2.size() / 2);
  Bytes cut_webp = solid_webp(3, 2, {10, 20, 30, 255});
  cut_webp.resize(cut_webp.size() - 8);
  for (const auto& [bytes, extension] : {std::pair{cut_ktx2, "KHR_texture_basisu"}, {cut_webp, "EXT_texture_webp"}}) {
    const json extensions = {{extension, {{"source", 0}}}};
    const Scene scene = load_texture({bytes, solid_png(5, 5, 1, 2, 3, 255)}, extensions, 1);
    EXPECT_EQ(scene.textures[0].width, 5) << extension;
    EXPECT_EQ(scene.warnings.size(), 1u) << extension;
    EXPECT_TRUE(mentions(scene.warnings, "the texture's other image, image 1, is used")) << scene.warnings.front();
    const Scene without = load_texture({bytes}, extensions, -1);
    EXPECT_EQ(without.textures[0].width, 1);
    EXPECT_TRUE(mentions(without.warnings, "one texel of a constant value replaces the texture"));
  }
}

TEST(GltfTexture, ManySmallFilesOfLargeImagesExceedABudget) {
  constexpr int kCount = 40;  // 32 fit the budget, and are then found damaged
  GltfBuilder file;
  for (int i = 0; i < kCount; ++i) {
    file.add("images", {{"uri", testing::data_uri(testing::webp_header(4096, 4096))}});
    file.add("textures", {{"extensions", {{"EXT_texture_webp", {{"source", i}}}}}});
    file.add_triangle_with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
  }
  const Scene scene = file.load();
  ASSERT_EQ(scene.textures.size(), static_cast<size_t>(kCount));
  const auto count = [&](const char* part) {
    return std::count_if(scene.warnings.begin(), scene.warnings.end(),
                         [&](const std::string& warning) { return warning.find(part) != warning.npos; });
  };
  EXPECT_EQ(count("damaged WebP image"), 32);
  EXPECT_EQ(count("exceed the limit for the images of a scene"), kCount - 32);
  for (const Texture& texture : scene.textures) EXPECT_EQ(texture.width, 1);
}

/// Loads a file in `folder` of one texture with the image at `uri`.
Scene load_image(const SceneFolder& folder, const std::string& uri, const json& extras = json::object()) {
  GltfBuilder file;
  file.add("images", {{"uri", uri}});
  file.add("textures", {{"source", 0}, {"extras", extras}});
  file.add_triangle_with_material({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  return load_scene(folder.write("a.gltf", file.text()));
}

TEST(GltfTexture, ImagesAreFoundByNameIfTheirPathIsFromAnotherMachine) {
  const char* const kUris[] = {R"(C:\art\wood.png)",  "C:/art/wood.png",         R"(\\srv\x\wood.png)",
                               R"(..\art\wood.png)",  "file:///C:/art/wood.png", "file://srv/x/wood.png",
                               "C:%5Cart%5Cwood.png", "/nowhere/wood.png",       "art/wood.png"};
  for (const char* const place : {"wood.png", "textures/wood.png"}) {
    const SceneFolder folder;
    std::filesystem::create_directory(folder.path() / "textures");
    const auto wood = folder.write(place, solid_png(2, 2, 90, 20, 30, 255));
    for (const char* const uri : kUris) {
      const Scene scene = load_image(folder, uri);
      EXPECT_TRUE(scene.warnings.empty()) << uri;
      EXPECT_EQ(scene.textures.at(0).texels.at(0), std::byte{90}) << uri;
      EXPECT_EQ(scene.source_files, (std::vector{folder.path() / "a.gltf", wood})) << uri;
    }
  }
}

TEST(GltfTexture, FloatImagesAreFoundByName) {
  const SceneFolder folder;
  folder.write("wood.png", solid_png(1, 1, 90, 20, 30, 255));
  write_image(folder.path() / "bright.exr", Image(1, 1));
  const Scene scene = load_image(folder, "wood.png", {{"relume", {{"image", R"(C:\art\bright.exr)"}}}});
  EXPECT_EQ(scene.textures.at(0).format, PixelFormat::rgba32_float);
}

TEST(GltfTexture, ThePathAsWrittenComesFirst) {
  const SceneFolder folder;
  std::filesystem::create_directory(folder.path() / "art");
  folder.write("wood.png", solid_png(1, 1, 10, 0, 0, 255));
  const auto wood = folder.write("art/wood.png", solid_png(1, 1, 20, 0, 0, 255));
  const auto red = [&](const std::string& uri) { return load_image(folder, uri).textures.at(0).texels.at(0); };
  EXPECT_EQ(red("art/wood.png"), std::byte{20});
  EXPECT_EQ(red("file://" + wood.string()), std::byte{20});
  EXPECT_EQ(red(R"(art\wood.png)"), std::byte{20});
  folder.write(R"(art\wood.png)", solid_png(1, 1, 30, 0, 0, 255));  // a backslash in its name
  EXPECT_EQ(red(R"(art\wood.png)"), std::byte{30});
  EXPECT_TRUE(mentions(load_image(folder, R"(C:\art\oak.png)").warnings, R"(C:\art\oak.png: the file does not exist)"));
  EXPECT_TRUE(mentions(load_image(folder, "https://a.b/oak.png").warnings, "not a local file"));
  EXPECT_TRUE(mentions(load_image(folder, "wood.png%00").warnings, "zero byte"));
}

TEST(GltfTexture, KeepsTheImageFile) {
  const Bytes png = solid_png(2, 2, 1, 2, 3, 255);
  const Scene scene = load_texture({png}, json::object(), 0);
  ASSERT_TRUE(scene.textures[0].file);
  EXPECT_EQ(*scene.textures[0].file, png);
}

}  // namespace
}  // namespace relume
