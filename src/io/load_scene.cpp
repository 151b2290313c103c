#include <cstring>
#include <fstream>

#include "io/extension.h"
#include "io/scene_io.h"

namespace relume {
namespace {

bool starts_as_glb(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return false;
  char magic[4] = {};
  std::ifstream(file, std::ios::binary).read(magic, sizeof magic);
  return std::memcmp(magic, "glTF", sizeof magic) == 0;
}

}  // namespace

Scene load_scene(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  if (extension == ".gltf" || extension == ".glb" || starts_as_glb(file)) return load_gltf(file);
  if (extension == ".json") return load_relume_json(file);
  return load_assimp(file);
}

}  // namespace relume
