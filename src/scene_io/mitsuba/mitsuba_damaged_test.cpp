// Checks that damaged and hostile files of Mitsuba give a scene or an Error in bounded memory. Seeds are fixed.
#include <random>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "relume/error.h"
#include "scene_io/mitsuba/mitsuba_meshes.h"
#include "scene_io/testing/example_files.h"
#include "scene_io/testing/mitsuba_scene.h"
#include "scene_io/testing/serialized_file.h"

namespace relume {
namespace {

using testing::append_number;
using testing::error_of;
using testing::example_files;
using testing::ExampleFile;
using testing::load_mitsuba_text;
using testing::SceneFolder;

/// Folder with the example and the files that it references.
struct Examples : SceneFolder {
  Examples() {
    for (const ExampleFile& file : example_files()) write(file.name, file.bytes);
  }
};

std::string mitsuba_example() {
  for (const ExampleFile& file : example_files()) {
    if (file.name == "a.xml") return {reinterpret_cast<const char*>(file.bytes.data()), file.bytes.size()};
  }
  return {};
}

/// Places of the values of attributes.
std::vector<std::pair<size_t, size_t>> values_of(const std::string& text) {
  std::vector<std::pair<size_t, size_t>> values;
  for (size_t at = text.find("=\""); at != std::string::npos; at = text.find("=\"", at + 2)) {
    const size_t end = text.find('"', at + 2);
    if (end == std::string::npos) break;
    values.emplace_back(at + 2, end - at - 2);
  }
  return values;
}

/// Replaces values by extreme ones, lines by others, or bytes.
std::string damaged(std::string text, uint32_t seed) {
  constexpr const char* kValues[] = {"",      "-1",    "0",      "1e308", "-1e30", "nan",     "9223372036854775807",
                                     "$size", "$",     "a",      "..",    "1 2",   "1, 2, 3", "400:1 300:2",
                                     "true",  "paint", "sphere", "merge", "0.5",   "1e-320",  "#123456"};
  std::mt19937 random(seed);
  for (uint32_t i = 0; i < 1 + seed % 3; ++i) {
    if (seed % 4 < 2) {
      const auto places = values_of(text);
      if (places.empty()) break;
      const auto [at, size] = places[random() % places.size()];
      text.replace(at, size, kValues[random() % std::size(kValues)]);
    } else if (seed % 4 == 2) {
      const size_t from = text.rfind('\n', random() % text.size());
      const size_t end = text.find('\n', from == std::string::npos ? 0 : from + 1);
      const std::string line = text.substr(from == std::string::npos ? 0 : from, end - from);
      text.insert(text.rfind('\n', random() % text.size()) + 1, random() % 2 ? line : line + line);
    } else {
      text[random() % text.size()] = static_cast<char>(random());
    }
  }
  return text;
}

TEST(MitsubaDamaged, FilesGiveASceneOrAnError) {
  constexpr uint32_t kFiles = 500;
  const Examples folder;
  const std::string intact = mitsuba_example();
  uint32_t loaded = 0;
  for (uint32_t seed = 0; seed < kFiles; ++seed) {
    const std::string text = damaged(intact, seed);
    try {
      load_mitsuba_from_memory(testing::to_bytes(text), folder.path(), "a.xml");
      ++loaded;
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find("a."), std::string::npos) << error.what();
    } catch (const std::exception& exception) {
      ADD_FAILURE() << "seed " << seed << ": " << exception.what();
    }
  }
  EXPECT_GT(loaded, kFiles / 5);
  EXPECT_LT(loaded, kFiles * 4 / 5);
}

Mesh read_serialized(std::span<const std::byte> file, int64_t index) {
  uint64_t inflatable = mitsuba::largest_inflated(file.size());
  return mitsuba::read_serialized(file, index, "a.serialized", inflatable);
}

TEST(MitsubaDamaged, MeshesGiveAMeshOrAnError) {
  std::mt19937 random(1);
  for (const uint16_t version : {uint16_t{3}, uint16_t{4}, uint16_t{5}}) {
    const Bytes intact = testing::serialized_file(version);
    for (int i = 0; i < 300; ++i) {
      Bytes bytes = intact;
      for (int k = 0; k < 1 + i % 4; ++k) bytes[random() % bytes.size()] = static_cast<std::byte>(random());
      error_of([&] { read_serialized(bytes, i % 3); });
    }
    for (size_t size = 0; size < intact.size(); ++size)
      EXPECT_NE(error_of([&] { read_serialized({intact.data(), size}, 1); }), "") << size;
  }
}

/// Header of a mesh that claims `vertices`, then zeros.
Bytes hollow_mesh(uint64_t vertices, size_t zeros) {
  Bytes body;
  append_number(body, uint32_t{0x1000});
  append_number(body, uint8_t{0});
  append_number(body, vertices);
  append_number(body, uint64_t{1});
  body.resize(body.size() + zeros);
  return testing::serialized_mesh(4, body);
}

TEST(MitsubaDamaged, MeshesThatCannotFitAreRefusedBeforeTheyAreAllocated) {
  EXPECT_NE(error_of([] { read_serialized(hollow_mesh(0xfffffff0u, 0), 0); }).find("do not fit"), std::string::npos);
  EXPECT_NE(error_of([] { read_serialized(hollow_mesh(uint64_t{1} << 40, 0), 0); }).find("2^32"), std::string::npos);
  // 24 MB of zeros in 24 kB
  EXPECT_NE(error_of([] { read_serialized(hollow_mesh(2000000, 24000000), 0); }).find("do not fit"), std::string::npos);
}

/// Files with `count` meshes, all of them the first one, and a scene of them.
std::string repeated_meshes(const SceneFolder& folder, uint32_t count) {
  Bytes file = hollow_mesh(1000000, 12000012);
  for (uint32_t i = 0; i < count; ++i) append_number(file, uint64_t{0});
  append_number(file, count);
  folder.write("a.serialized", file);
  std::string scene;
  for (uint32_t i = 0; i < count; ++i)
    scene +=
        "<shape type=\"serialized\"><string name=\"filename\" value=\"a.serialized\"/><integer "
        "name=\"shape_index\" value=\"" +
        std::to_string(i) + "\"/></shape>";
  return scene;
}

TEST(MitsubaDamaged, MeshesOfOneFileShareItsLimit) {
  const SceneFolder folder;
  EXPECT_NO_THROW(load_mitsuba_text(repeated_meshes(folder, 1), folder.path()));
  EXPECT_NE(error_of([&] { load_mitsuba_text(repeated_meshes(folder, 100), folder.path()); }).find("do not fit"),
            std::string::npos);
}

TEST(MitsubaDamaged, InstancesAreBounded) {
  std::string group = "<shape type=\"shapegroup\" id=\"g\">";
  for (int i = 0; i < 2000; ++i) group += "<shape type=\"cube\"/>";
  group += "</shape>";
  for (int i = 0; i < 2200; ++i) group += "<shape type=\"instance\"><ref id=\"g\"/></shape>";
  EXPECT_NE(error_of([&] { load_mitsuba_text(group); }).find("more than 4194304 instances"), std::string::npos);
}

TEST(MitsubaDamaged, MergesThatDoubleAreBounded) {
  std::string text = "<shape type=\"cube\" id=\"s30\"/>";
  for (int i = 0; i < 30; ++i) {
    const std::string ref = "<ref id=\"s" + std::to_string(i + 1) + "\"/>";
    text += "<shape type=\"merge\" id=\"s" + std::to_string(i) + "\">" + ref + ref + "</shape>";
  }
  EXPECT_NE(error_of([&] { load_mitsuba_text(text); }).find("more than 1048576 shapes"), std::string::npos);
  // Shapes of many BSDFs, which show nothing.
  std::string idle = "<shape type=\"merge\" id=\"m\">";
  for (int i = 0; i < 2000; ++i) idle += "<bsdf type=\"diffuse\"/>";
  idle += "</shape>";
  for (int i = 0; i < 2000; ++i) idle += "<ref id=\"m\"/>";
  EXPECT_NE(error_of([&] { load_mitsuba_text(idle); }).find("more than 1048576 shapes"), std::string::npos);
}

/// Spheres with a BSDF each.
std::string spheres(int count) {
  std::string text;
  for (int i = 0; i < count; ++i) text += "<shape type=\"sphere\"><bsdf type=\"diffuse\"/></shape>";
  return text;
}

TEST(MitsubaDamaged, CopiesOfMeshesAreBounded) {
  const Scene many = load_mitsuba_text(spheres(9000));
  EXPECT_EQ(many.meshes.size(), 9000u);
  EXPECT_EQ(many.meshes[0].triangles.size(), 2u * 24 * 11);
  const SceneFolder folder;
  std::string grid;
  for (int i = 0; i < 20000; ++i) grid += "v " + std::to_string(i % 100) + " " + std::to_string(i / 100) + " 0\n";
  for (int i = 1; i < 19900; ++i)
    grid += "f " + std::to_string(i) + " " + std::to_string(i + 1) + " " + std::to_string(i + 100) + "\n";
  folder.write("a.obj", grid);
  std::string text;
  for (int i = 0; i < 1000; ++i)
    text += "<shape type=\"obj\"><string name=\"filename\" value=\"a.obj\"/><bsdf type=\"diffuse\"/></shape>";
  EXPECT_NE(error_of([&] { load_mitsuba_text(text, folder.path()); }).find("the meshes of further materials"),
            std::string::npos);
  std::string lamps;  // of which each needs a material
  for (int i = 0; i < 132000; ++i) lamps += "<shape type=\"rectangle\"><emitter type=\"area\"/></shape>";
  EXPECT_NE(error_of([&] { load_mitsuba_text(lamps); }).find("more than 131072 materials"), std::string::npos);
}

TEST(MitsubaDamaged, UnusedIndicesDoNotCopyShapes) {
  std::string text;
  for (int i = 0; i < 3; ++i)
    text += "<shape type=\"sphere\"><integer name=\"shape_index\" value=\"" + std::to_string(i) + "\"/></shape>";
  EXPECT_EQ(load_mitsuba_text(text).meshes.size(), 1u);
}

TEST(MitsubaDamaged, TextsAreBounded) {
  const SceneFolder folder;
  const auto include = [&](const std::string& file, int times) {
    std::string text;
    for (int i = 0; i < times; ++i) text += "<include filename=\"" + file + "\"/>";
    return error_of([&] { load_mitsuba_text(text, folder.path()); });
  };
  const auto scene_of = [](const std::string& elements) { return "<scene version=\"3.0.0\">" + elements + "</scene>"; };
  folder.write("comment.xml", scene_of("<!--" + std::string(1 << 20, 'x') + "-->"));
  EXPECT_NE(include("comment.xml", 300).find("more than 256 MiB of text"), std::string::npos);
  std::string floats;
  for (int i = 0; i < 50; ++i) floats += "<float name=\"a\" value=\"1\"/>";
  std::string bsdfs;
  for (int i = 0; i < 60; ++i) bsdfs += "<bsdf type=\"diffuse\">" + floats + "</bsdf>";
  folder.write("floats.xml", scene_of(bsdfs));
  EXPECT_NE(include("floats.xml", 900).find("more than 2097152 objects and parameters"), std::string::npos);
  EXPECT_NE(error_of([&] {
              load_mitsuba_text("<bsdf type=\"diffuse\">" + floats + floats + floats + "</bsdf>");
            }).find("<bsdf> has more than 100 parameters"),
            std::string::npos);
  folder.write("spectrum.spd", "400 1\n500 2 #" + std::string(1 << 22, ' ') + "\n");
  std::string spectra = "<bsdf type=\"diffuse\">";
  for (int i = 0; i < 70; ++i) spectra += "<spectrum name=\"a\" filename=\"spectrum.spd\"/>";
  EXPECT_NE(error_of([&] { load_mitsuba_text(spectra + "</bsdf>", folder.path()); }).find("more than 256 MiB of text"),
            std::string::npos);
  std::string many = "<bsdf type=\"diffuse\">";
  for (int i = 0; i < 8400000; ++i) many += "<a/>";
  EXPECT_NE(error_of([&] { load_mitsuba_text(many + "</bsdf>"); }).find("8388608 elements and attributes"),
            std::string::npos);
}

TEST(MitsubaDamaged, SearchesAreBounded) {
  // 20 texts of 1 MB that start no known name; in each, a search of all lengths would take a minute.
  const std::string name = "$" + std::string(1000000, 'a');
  for (int i = 0; i < 20; ++i)
    EXPECT_NE(error_of([&] { load_mitsuba_text("<string name=\"a\" value=\"" + name + "\"/>"); }).find("has no value"),
              std::string::npos);
  EXPECT_NE(
      error_of([&] { load_mitsuba_text("<default name=\"" + name.substr(1) + "\" value=\"\"/>"); }).find("shorten it"),
      std::string::npos);
  std::string paths;
  for (int i = 0; i < 70; ++i) paths += "<path value=\"p" + std::to_string(i) + "\"/>";
  EXPECT_NE(error_of([&] { load_mitsuba_text(paths); }).find("more than 64 <path> elements"), std::string::npos);
}

TEST(MitsubaDamaged, PipesAreNotRead) {
  const SceneFolder folder;
  ASSERT_EQ(mkfifo((folder.path() / "pipe").c_str(), 0600), 0);
  const Scene scene = load_mitsuba_text(
      "<emitter type=\"envmap\"><string name=\"filename\" value=\"pipe\"/></emitter><shape type=\"cube\"/>",
      folder.path());
  EXPECT_EQ(scene.environment.kind, EnvironmentKind::automatic);
  ASSERT_EQ(scene.warnings.size(), 1u);
  EXPECT_NE(scene.warnings[0].find("pipe: this is not a regular file; the environment map is left out"),
            std::string::npos);
}

TEST(MitsubaDamaged, SharedBsdfsAreReadOnce) {
  std::string text = "<bsdf type=\"diffuse\" id=\"b0\"/>";
  for (int i = 1; i < 25; ++i) {
    const std::string ref = "<ref id=\"b" + std::to_string(i - 1) + "\"/>";
    text += "<bsdf type=\"blendbsdf\" id=\"b" + std::to_string(i) + "\"><float name=\"weight\" value=\"0.5\"/>" + ref +
            ref + "</bsdf>";
  }
  const Scene scene = load_mitsuba_text(text + "<shape type=\"cube\"><ref id=\"b24\"/></shape>");
  EXPECT_EQ(scene.materials.at(0).name, "b24");
  std::string mixed = "<bsdf type=\"conductor\" id=\"b0\"/>";
  for (int i = 1; i <= kMaxMixDepth + 1; ++i)
    mixed += "<bsdf type=\"blendbsdf\" id=\"b" + std::to_string(i) +
             "\"><float name=\"weight\" value=\"0.5\"/><ref id=\"b" + std::to_string(i - 1) +
             "\"/><bsdf type=\"diffuse\"/></bsdf>";
  const auto nested = [&](int depth) {
    return load_mitsuba_text(mixed + "<shape type=\"cube\"><ref id=\"b" + std::to_string(depth) + "\"/></shape>");
  };
  EXPECT_NE(nested(kMaxMixDepth).materials.at(0).mix_first, kNone);
  const Scene too_deep = nested(kMaxMixDepth + 1);
  EXPECT_EQ(too_deep.materials.at(0).mix_first, kNone);
  EXPECT_TRUE(testing::mentions(too_deep.warnings, "more than 16 nested BSDFs of type 'blendbsdf'"));
  std::string textures = "<texture type=\"checkerboard\" id=\"t0\"/>";
  for (int i = 1; i < 25; ++i) {
    const std::string last = " id=\"t" + std::to_string(i - 1) + "\"/>";
    textures += "<texture type=\"checkerboard\" id=\"t" + std::to_string(i) + "\"><ref name=\"color0\"" + last +
                "<ref name=\"color1\"" + last + "</texture>";
  }
  load_mitsuba_text(
      textures + "<shape type=\"cube\"><bsdf type=\"diffuse\"><ref name=\"reflectance\" id=\"t24\"/></bsdf></shape>");
}

TEST(MitsubaDamaged, MemoryIsBounded) {
  constexpr long kLimit_KiB = 2 << 20;
  rusage self{};
  ASSERT_EQ(getrusage(RUSAGE_SELF, &self), 0);
  EXPECT_LT(self.ru_maxrss, kLimit_KiB) << "KiB, of the tests above";
}

}  // namespace
}  // namespace relume
