#include <cstring>
#include <fstream>
#include <sstream>
#include <string_view>

#include "files/extension.h"
#include "files/read_record.h"
#include "scene_io/scene_io.h"

namespace relume {
namespace {

bool starts_as_glb(const std::filesystem::path& file) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) return false;
  char magic[4] = {};
  std::ifstream(file, std::ios::binary).read(magic, sizeof magic);
  return std::memcmp(magic, "glTF", sizeof magic) == 0;
}

/// Material libraries that an OBJ file names near its beginning. Assimp reads them past our functions.
void record_material_libraries(const std::filesystem::path& file) {
  constexpr std::string_view kKeyword = "mtllib";
  constexpr std::string_view kBlanks = " \t\r\v\f";
  std::string start(size_t{1} << 20, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<size_t>(in.gcount()));
  std::istringstream lines(start);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string word;
    if (!(words >> word) || word != kKeyword) continue;
    // Names are separated by blanks, or one name contains them.
    std::string names;
    std::getline(words >> std::ws, names);
    names.erase(names.find_last_not_of(kBlanks) + 1);
    if (!names.empty()) record_read(file.parent_path() / names);
    for (std::istringstream rest(names); rest >> word;) record_read(file.parent_path() / word);
  }
}

Scene load(const std::filesystem::path& file) {
  const std::string extension = lower_extension(file);
  if (extension == ".gltf" || extension == ".glb" || starts_as_glb(file)) return load_gltf(file);
  if (extension == ".json") return load_relume_json(file);
  if (extension == ".obj") record_material_libraries(file);
  return load_assimp(file);
}

}  // namespace

Scene load_scene(const std::filesystem::path& file) {
  const ReadRecord record;
  record_read(file);  // assimp reads it past our functions
  Scene scene = load(file);
  scene.source_files = record.files();
  return scene;
}

}  // namespace relume
