// Fuzzes checkpoints with a valid checksum: any bytes give an Error, or a session that continues. The first byte
// selects techniques with their own state; its highest bit selects whether a valid header precedes the bytes.
#include <cstdint>
#include <fstream>
#include <string>

#include "checkpoint_case.h"
#include "relume/error.h"
#include "scratch.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const relume::fuzz::Scratch scratch(".checkpoint");
  if (size == 0) return 0;
  const bool header_fits = data[0] < relume::fuzz::kWithHeader;
  relume::Session session = relume::fuzz::checkpoint_session(data[0] % relume::fuzz::kWithHeader);
  session.save_checkpoint(scratch.path);
  std::string checkpoint = relume::fuzz::contents(scratch.path);
  checkpoint.resize(header_fits ? relume::fuzz::header_size(checkpoint) : 0);
  checkpoint.append(reinterpret_cast<const char*>(data) + 1, size - 1);
  std::ofstream(scratch.path, std::ios::binary) << checkpoint << relume::fuzz::checksum(checkpoint);
  try {
    session.load_checkpoint(scratch.path);
    for (int i = 0; i < 2; ++i) session.render_frame();
  } catch (const relume::Error&) {
    // Expected for damaged input.
  }
  return 0;
}
