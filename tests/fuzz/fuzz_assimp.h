// Shared code of the targets with assimp as their parser. assimp crashes on some damaged files; it runs in a child
// process, and relume reports an Error. Such crashes are counted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>

#include "relume/error.h"
#include "rendered.h"
#include "scene_io/assimp/assimp_loader.h"

/// Reports the number of assimp's crashes at the end of the run.
class CrashCount {
 public:
  ~CrashCount() { std::fprintf(stderr, "assimp crashed on %zu of %zu files\n", crashed_, files_); }
  void add(bool crashed) {
    ++files_;
    crashed_ += crashed ? 1 : 0;
  }

 private:
  size_t files_ = 0;
  size_t crashed_ = 0;
};

/// Expects any bytes to give a scene that renders or an Error.
inline void read_by_assimp(const uint8_t* data, size_t size, const std::string& extension) {
  static CrashCount count;
  const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  bool crashed = false;
  try {
    relume::fuzz::render_two_frames(relume::load_assimp_from_memory(bytes, extension, "fuzz." + extension));
  } catch (const relume::Error& error) {
    crashed = std::string_view(error.what()).find("reading crashed") != std::string_view::npos;
  }
  count.add(crashed);
}
