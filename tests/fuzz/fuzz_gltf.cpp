// Fuzzes the glTF and GLB reader: any bytes give a scene that renders or an Error.
#include <cstddef>
#include <cstdint>
#include <span>

#include "relume/error.h"
#include "rendered.h"
#include "scene_io/gltf/gltf_loader.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  try {
    relume::fuzz::render_two_frames(relume::load_gltf_from_memory(bytes, "/nonexistent", "fuzz.gltf"));
  } catch (const relume::Error&) {
    // Expected for damaged input.
  }
  return 0;
}
