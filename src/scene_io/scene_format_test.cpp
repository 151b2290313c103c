#include "scene_io/scene_format.h"

#include <fstream>
#include <iterator>
#include <set>

#include <gtest/gtest.h>

#include "relume/error.h"
#include "relume/scene_io.h"
#include "scene_io/testing/scene_files.h"

namespace relume {
namespace {

using testing::SceneFolder;

TEST(SceneFormat, EachExtensionHasOneFormat) {
  std::set<std::string_view> known;
  for (const SceneFormat& format : scene_formats()) {
    EXPECT_FALSE(format.extensions.empty()) << format.name;
    EXPECT_NE(format.load, nullptr) << format.name;
    for (const std::string_view extension : format.extensions) {
      EXPECT_TRUE(known.insert(extension).second) << extension;
      EXPECT_EQ(&scene_format_of("missing." + std::string(extension)), &format);
    }
  }
}

TEST(SceneFormat, TheExtensionSelectsTheWrittenFormat) {
  const SceneFolder folder;
  Scene scene;
  scene.environment.kind = EnvironmentKind::constant;
  for (const char* name : {"a.gltf", "a.GLB", "a.pbrt", "a.PBRT"}) {
    write_scene(folder.path() / name, scene);
    EXPECT_EQ(load_scene(folder.path() / name).environment.kind, EnvironmentKind::constant) << name;
  }
  const std::string problem = testing::error_of([&] { write_scene(folder.path() / "a.xml", scene); });
  EXPECT_NE(problem.find("a.xml: scenes are written as .gltf, .glb or .pbrt"), std::string::npos) << problem;
}

TEST(SceneFormat, TheSignatureCountsMoreThanTheExtension) {
  const SceneFolder folder;
  EXPECT_EQ(scene_format_of(folder.write("room.ply", "glTF\2")).name, "glTF");
  EXPECT_EQ(scene_format_of(folder.write("room.PLY", "glT")).name, "PLY");
}

TEST(SceneFormat, ErrorsForUnknownFormatsListAllExtensions) {
  try {
    scene_format_of("room.xyz");
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(),
                 "room.xyz: scene files with extension 'xyz' are not supported; use gltf, glb, json, pbrt, pbrt.gz, "
                 "xml, ply, obj, fbx, "
                 "dae, stl, 3ds, off");
  }
}

TEST(SceneFormat, ErrorsForForeignFormatsNameTheWayToGltf) {
  const auto sentence = [](const char* file) -> std::string {
    try {
      scene_format_of(file);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  };
  EXPECT_EQ(sentence("car.blend"), "car.blend: Blender files are not read; export glTF 2.0 from Blender");
  for (const char* file : {"car.usd", "car.USDA", "car.usdc", "car.usdz"})
    EXPECT_EQ(
        sentence(file),
        std::string(file) + ": USD files are not read; import the file into Blender and export glTF 2.0 from there");
}

TEST(SceneFormat, CompressedFilesCountByBothExtensions) {
  EXPECT_EQ(scene_format_of("a/room.pbrt.gz").name, "pbrt");
  EXPECT_EQ(scene_format_of("a/room.PBRT.GZ").name, "pbrt");
  EXPECT_THROW(scene_format_of("a/room.gz"), Error);
}

TEST(SceneFormat, NamesMakeAPhrase) {
  EXPECT_EQ(scene_format_names(), "glTF, relume JSON, pbrt, Mitsuba, PLY, OBJ, FBX, DAE, STL, 3DS or OFF");
}

TEST(SceneFormat, TheReferencePageIsUpToDate) {
  std::ifstream stream(std::filesystem::path(RELUME_SOURCE_DIR) / "docs" / "scene-formats.md");
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  EXPECT_EQ(text, scene_formats_reference()) << "regenerate: relume scenes --formats > docs/scene-formats.md";
}

}  // namespace
}  // namespace relume
