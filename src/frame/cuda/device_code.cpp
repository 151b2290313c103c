#include "frame/cuda/device_code.h"

#include <cstdint>
#include <stdexcept>

#ifdef RELUME_EMBEDDED_CODE
#include <zstd.h>
#endif

namespace relume {

#ifdef RELUME_EMBEDDED_CODE

namespace {
/// A frame of Zstandard, and zeros up to the next word.
constexpr uint64_t kCompressed[] = {
#include RELUME_EMBEDDED_CODE
};
}  // namespace

std::string device_code() {
  const size_t compressed = ZSTD_findFrameCompressedSize(kCompressed, sizeof(kCompressed));
  std::string code(ZSTD_getFrameContentSize(kCompressed, sizeof(kCompressed)), '\0');
  const size_t written = ZSTD_decompress(code.data(), code.size(), kCompressed, compressed);
  if (written != code.size()) throw std::logic_error("the device code in the library is damaged");
  return code;
}

size_t device_code_bytes() { return sizeof(kCompressed); }

#else

std::string device_code() { return {}; }

size_t device_code_bytes() { return 0; }

#endif

}  // namespace relume
