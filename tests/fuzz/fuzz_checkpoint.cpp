// Fuzzes checkpoints between their header, which fits, and their checksum, which is right: any bytes end in an Error,
// or in a session that renders on. The first byte chooses techniques that keep a state of their own.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include <unistd.h>

#include "checkpoint_case.h"
#include "core/error.h"

namespace {

/// In memory, where there is such a folder.
std::filesystem::path scratch_file() {
  const std::filesystem::path memory = "/dev/shm";
  const std::filesystem::path folder =
      std::filesystem::is_directory(memory) ? memory : std::filesystem::temp_directory_path();
  return folder / ("relume_fuzz_" + std::to_string(getpid()) + ".checkpoint");
}

/// The file is removed at the end.
struct Scratch {
  Scratch() : file(scratch_file()) {}
  ~Scratch() { std::filesystem::remove(file); }
  Scratch(const Scratch&) = delete;
  Scratch& operator=(const Scratch&) = delete;
  const std::filesystem::path file;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const Scratch scratch;
  if (size == 0) return 0;
  relume::Session session = relume::fuzz::checkpoint_session(data[0]);
  session.save_checkpoint(scratch.file);
  std::string checkpoint = relume::fuzz::contents(scratch.file);
  checkpoint.resize(relume::fuzz::header_size(checkpoint));
  checkpoint.append(reinterpret_cast<const char*>(data) + 1, size - 1);
  std::ofstream(scratch.file, std::ios::binary) << checkpoint << relume::fuzz::checksum(checkpoint);
  try {
    session.load_checkpoint(scratch.file);
    for (int i = 0; i < 2; ++i) session.render_frame();
  } catch (const relume::Error&) {
    // The expected answer to damaged input.
  }
  return 0;
}
