// Fuzzes the image readers, for textures and for measured images: any bytes give an image or an Error.
#include <cstddef>
#include <cstdint>
#include <span>

#include "relume/error.h"
#include "relume/image_io.h"
#include "scene_io/texture_decode.h"

namespace {

template <typename Read>
void try_to(const Read& read) {
  try {
    read();
  } catch (const relume::Error&) {
    // Expected for damaged input.
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  try_to([&] { relume::decode_texture(bytes, "fuzz", relume::PixelFormat::rgba8_srgb); });
  try_to([&] { relume::parse_image(bytes, "fuzz"); });
  return 0;
}
