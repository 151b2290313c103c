// File name extensions.
#pragma once

#include <cctype>
#include <filesystem>
#include <string>

namespace relume {

/// Extension in lower case with its dot (".gltf"); empty without one.
inline std::string lower_extension(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

}  // namespace relume
