// Fuzzes the pbrt reader: any bytes give a scene that renders or an Error.
#include <cstddef>
#include <cstdint>
#include <span>

#include "relume/error.h"
#include "rendered.h"
#include "scene_io/pbrt/pbrt_loader.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  try {
    relume::fuzz::render_two_frames(relume::load_pbrt_from_memory(bytes, "/nonexistent", "fuzz.pbrt"));
  } catch (const relume::Error&) {
    // Expected for damaged input.
  }
  return 0;
}
