// Checks that files with random damage give a scene or an Error within the memory limits. Seeds are fixed.
#include <random>

#include <gtest/gtest.h>
#include <sys/resource.h>

#include "scene_io/assimp/assimp_loader.h"
#include "scene_io/ply/ply_loader.h"
#include "scene_io/testing/example_files.h"

namespace relume {
namespace {

using testing::example_files;
using testing::ExampleFile;

constexpr long kLimit_KiB = 2 << 20;

std::string extension_of(const std::string& name) { return name.substr(name.rfind('.') + 1); }

/// Whether the format is none of whole scenes: not glTF, JSON, pbrt or Mitsuba.
bool is_mesh_format(const ExampleFile& file) {
  const std::string extension = extension_of(file.name);
  return extension != "gltf" && extension != "glb" && extension != "json" && extension != "pbrt" && extension != "xml";
}

/// Truncates a third of the files. In others, changes up to eight bytes to any value or to a character of text formats.
Bytes damaged(Bytes bytes, uint32_t seed) {
  constexpr std::string_view kCharacters = "0123456789<>/\" -.\n";
  std::mt19937 random(seed);
  if (seed % 3 == 0) {
    bytes.resize(1 + random() % (bytes.size() - 1));
    return bytes;
  }
  const uint32_t changes = 1 + random() % 8;
  for (uint32_t i = 0; i < changes; ++i) {
    const uint32_t value =
        seed % 3 == 1 ? random() : static_cast<unsigned char>(kCharacters[random() % kCharacters.size()]);
    bytes[random() % bytes.size()] = static_cast<std::byte>(value);
  }
  return bytes;
}

/// Checks that messages for users contain no terms of assimp's code.
void expect_plain(const std::string& message) {
  for (const char* jargon : {"ssimp", "aiScene", "aiMesh", "mNum", "mFaces", "Deadly", "Collada", "OBJ", "FBX-", "OFF:",
                             "STL:", "TOK_", "std::", "vector::", "alloc", "nullptr", "Validation", "basic_string"})
    EXPECT_EQ(message.find(jargon), std::string::npos) << message;
}

/// Whether the file loads. Fails the test on any exception except Error.
bool loads(const std::string& name, const Bytes& bytes, const std::string& what) {
  try {
    if (extension_of(name) == "ply") {
      load_ply_from_memory(bytes, name);
    } else {
      load_assimp_from_memory(bytes, extension_of(name), name);
    }
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(std::string_view(error.what()).find(name + ": "), 0u) << what << ": " << error.what();
    expect_plain(error.what());
  } catch (const std::exception& exception) {
    ADD_FAILURE() << name << " " << what << ": " << exception.what();
  }
  return false;
}

/// Loads `count` damaged files per format.
void read_damaged(uint32_t count) {
  for (const ExampleFile& file : example_files()) {
    if (!is_mesh_format(file)) continue;
    uint32_t loaded = 0;
    for (uint32_t seed = 0; seed < count; ++seed)
      loaded += loads(file.name, damaged(file.bytes, seed), "seed " + std::to_string(seed)) ? 1 : 0;
    EXPECT_LT(loaded, count) << file.name << ": the damage has no effect";
  }
  rusage self{};
  rusage children{};
  ASSERT_EQ(getrusage(RUSAGE_SELF, &self), 0);
  ASSERT_EQ(getrusage(RUSAGE_CHILDREN, &children), 0);
  EXPECT_LT(self.ru_maxrss + children.ru_maxrss, kLimit_KiB) << "KiB, of this process and of the largest child";
}

TEST(DamagedFile, GivesASceneOrAnError) { read_damaged(40); }
TEST(SlowDamagedFile, GivesASceneOrAnError) { read_damaged(1000); }

}  // namespace
}  // namespace relume
