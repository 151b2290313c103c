#include "scene_io/assimp/assimp_textures.h"

#include <gtest/gtest.h>

#include "relume/scene_io.h"
#include "scene_io/testing/example_files.h"

namespace relume {
namespace {

using testing::dae_text;
using testing::encode_base64;
using testing::fbx_text;
using testing::mentions;
using testing::SceneFolder;
using testing::solid_png;

std::string replaced(std::string text, const std::string& old, const std::string& replacement) {
  return text.replace(text.find(old), old.size(), replacement);
}

std::string dae_with_texture(const std::string& path) {
  std::string text =
      replaced(dae_text(), "<library_geometries>",
               "<library_images><image id=\"i\"><init_from>" + path +
                   "</init_from></image></library_images><library_effects><effect id=\"e\"><profile_COMMON>"
                   "<newparam sid=\"s\"><surface type=\"2D\"><init_from>i</init_from></surface></newparam>"
                   "<newparam sid=\"t\"><sampler2D><source>s</source></sampler2D></newparam>"
                   "<technique sid=\"c\"><lambert><diffuse><texture texture=\"t\" texcoord=\"UV\"/></diffuse></lambert>"
                   "</technique></profile_COMMON></effect></library_effects><library_materials><material id=\"m\">"
                   "<instance_effect url=\"#e\"/></material></library_materials><library_geometries>");
  text = replaced(text, "<triangles count=\"1\">", "<triangles count=\"1\" material=\"m\">");
  return replaced(text, "<instance_geometry url=\"#g\"/>",
                  "<instance_geometry url=\"#g\"><bind_material><technique_common><instance_material symbol=\"m\" "
                  "target=\"#m\"/></technique_common></bind_material></instance_geometry>");
}

/// `image` is the content of an embedded file; empty: none.
std::string fbx_with_texture(const std::string& path, const Bytes& image = {}) {
  const std::string names = "  FileName: \"" + path + "\"\n  RelativeFilename: \"" + path + "\"\n";
  std::string text = replaced(fbx_text(1), "  GeometryVersion: 124\n",
                              "  GeometryVersion: 124\n  LayerElementMaterial: 0 {\n   Version: 101\n   Name: \"\"\n"
                              "   MappingInformationType: \"AllSame\"\n   ReferenceInformationType: \"IndexToDirect\"\n"
                              "   Materials: *1 {\n    a: 0\n   }\n  }\n  Layer: 0 {\n   Version: 100\n"
                              "   LayerElement: {\n    Type: \"LayerElementMaterial\"\n    TypedIndex: 0\n   }\n  }\n");
  std::string objects =
      " Material: 4, \"Material::m\", \"\" {\n  Version: 102\n  ShadingModel: \"lambert\"\n }\n"
      " Texture: 5, \"Texture::t\", \"\" {\n  TextureName: \"Texture::t\"\n" +
      names + " }\n";
  std::string connections = "Connections: {\n C: \"OO\",4,2\n C: \"OP\",5,4,\"DiffuseColor\"\n";
  if (!image.empty()) {
    objects += " Video: 6, \"Video::v\", \"Clip\" {\n  Type: \"Clip\"\n" + names + "  Content: , \"" +
               encode_base64(image) + "\"\n }\n";
    connections += " C: \"OO\",6,5\n";
  }
  text = replaced(text, " Model: 2", objects + " Model: 2");
  return replaced(text, "Connections: {\n", connections);
}

int red_of(const Scene& scene) {
  if (scene.textures.size() != 1 || scene.textures[0].texels.empty()) return -1;
  return std::to_integer<int>(scene.textures[0].texels[0]);
}

TEST(AssimpTextures, AreFoundByNameIfThePathIsFromAnotherMachine) {
  const char* const kPaths[] = {R"(C:\art\wood.png)",  R"(\\server\x\wood.png)", "C:/art/wood.png",
                                "//server/x/wood.png", "/nowhere/wood.png",      R"(..\art\wood.png)"};
  for (const char* const place : {"wood.png", "textures/wood.png"}) {
    const SceneFolder folder;
    std::filesystem::create_directory(folder.path() / "textures");
    folder.write(place, solid_png(2, 2, 90, 20, 30, 255));
    for (const std::string path : kPaths) {
      folder.write("a.mtl", "newmtl m\nmap_Kd " + path + "\n");
      const std::string obj = "mtllib a.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n";
      EXPECT_EQ(red_of(load_scene(folder.write("a.obj", obj))), 90) << path;
      EXPECT_EQ(red_of(load_scene(folder.write("a.dae", dae_with_texture(path)))), 90) << path;
      EXPECT_EQ(red_of(load_scene(folder.write("a.fbx", fbx_with_texture(path)))), 90) << path;
    }
  }
}

TEST(AssimpTextures, MayBeEmbedded) {
  const SceneFolder folder;
  const Scene scene = load_scene(folder.write("a.fbx", fbx_with_texture("wood.png", solid_png(2, 2, 90, 20, 30, 255))));
  EXPECT_EQ(red_of(scene), 90);
  EXPECT_TRUE(scene.warnings.empty());
  const Scene damaged = load_scene(folder.write("a.fbx", fbx_with_texture("wood.png", Bytes(20, std::byte{7}))));
  EXPECT_EQ(red_of(damaged), 255);
  EXPECT_TRUE(mentions(damaged.warnings, "wood.png: not a recognised image"));
}

}  // namespace
}  // namespace relume
