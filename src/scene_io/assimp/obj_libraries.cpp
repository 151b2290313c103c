#include "scene_io/assimp/obj_libraries.h"

#include <fstream>
#include <sstream>
#include <string>
#include <string_view>

#include "files/read_record.h"

namespace relume {

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
    // Blanks separate names, or belong to a single name: both are recorded.
    std::string names;
    std::getline(words >> std::ws, names);
    names.erase(names.find_last_not_of(kBlanks) + 1);
    if (!names.empty()) record_read(file.parent_path() / names);
    for (std::istringstream rest(names); rest >> word;) record_read(file.parent_path() / word);
  }
}

}  // namespace relume
