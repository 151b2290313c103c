// Temporary file for parsers that read files.
#pragma once

#include <filesystem>
#include <string>

#include <unistd.h>

namespace relume::fuzz {

/// Path in memory if such a folder exists, removed on destruction.
struct Scratch {
  explicit Scratch(const std::string& extension)
      : path(folder() / ("relume_fuzz_" + std::to_string(getpid()) + extension)) {}
  ~Scratch() { std::filesystem::remove_all(path); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;

  static std::filesystem::path folder() {
    const std::filesystem::path memory = "/dev/shm";
    return std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
  }

  const std::filesystem::path path;
};

}  // namespace relume::fuzz
