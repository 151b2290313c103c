// Fuzzes command-line texts: contenders, images, durations, ranges and names of frames, settings. Any text is parsed or
// gives an Error. The first byte selects the kind of text.
#include <cstdint>
#include <string>

#include "cli/frame_sequence.h"
#include "compare/contender.h"
#include "relume/error.h"
#include "settings/duration.h"

namespace {

/// NAME=TEXT, as in --NAME TEXT.
void read_flag(const std::string& text) {
  const size_t middle = text.find('=');
  if (middle == std::string::npos) return;
  relume::resolve({.flags = {{text.substr(0, middle), text.substr(middle + 1)}}});
}

void read_contenders(const std::string& text) {
  for (const relume::Contender& contender : relume::parse_contenders(text, "--techniques")) {
    if (contender.file.empty()) relume::resolve_contender(contender, {});
  }
}

void read_text(int kind, const std::string& text) {
  switch (kind) {
    case 0: read_contenders(text); return;
    case 1: relume::parse_image_contenders(text, "--image"); return;
    case 2: relume::parse_duration_s(text, "--time"); return;
    case 3: relume::cli::parse_frame_range(text, "--frames"); return;
    case 4: relume::cli::FrameNames(std::filesystem::path(text))(7); return;
    default: read_flag(text); return;
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  if (size == 0) return 0;
  try {
    read_text(data[0] % 6, {reinterpret_cast<const char*>(data) + 1, size - 1});
  } catch (const relume::Error&) {
    // Expected for invalid input.
  }
  return 0;
}
