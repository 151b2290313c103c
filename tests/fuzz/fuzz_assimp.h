// What the targets share whose parser is assimp. assimp crashes on some damaged files, so that a child process tries
// each first and relume refuses what would crash. That is no failure of relume, but it is not hidden either: it is
// counted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>

#include "core/error.h"
#include "io/assimp/assimp_loader.h"
#include "rendered.h"

/// assimp leaks when it gives up in the middle of a file. Under LeakSanitizer only this function is looked at.
extern "C" const char* __lsan_default_suppressions() { return "leak:libassimp"; }

/// Says at the end of the run how many files assimp would have crashed on.
class TrialCount {
 public:
  ~TrialCount() { std::fprintf(stderr, "assimp would have crashed on %zu of %zu files\n", refused_, files_); }
  void add(bool refused) {
    ++files_;
    refused_ += refused ? 1 : 0;
  }

 private:
  size_t files_ = 0;
  size_t refused_ = 0;
};

/// Any bytes end in a scene that renders or in an Error.
inline void read_by_assimp(const uint8_t* data, size_t size, const std::string& extension) {
  static TrialCount count;
  const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  bool refused = false;
  try {
    relume::fuzz::render_two_frames(relume::load_assimp_from_memory(bytes, extension, "fuzz." + extension));
  } catch (const relume::Error& error) {
    refused = std::string_view(error.what()).find("would crash") != std::string_view::npos;
  }
  count.add(refused);
}
