// Fuzzes the reader of Mitsuba's scenes: any bytes give a scene that renders or an Error. If the first byte is 0, the
// others are a "serialized" mesh; if it is 1, an OBJ file as Mitsuba reads it.
#include <cstddef>
#include <cstdint>
#include <span>

#include "relume/error.h"
#include "rendered.h"
#include "scene_io/mitsuba/mitsuba_loader.h"
#include "scene_io/mitsuba/mitsuba_meshes.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  try {
    if (size > 0 && data[0] == 0) {
      uint64_t inflatable = relume::mitsuba::largest_inflated(size);
      relume::mitsuba::read_serialized(bytes.subspan(1), 0, "fuzz.serialized", inflatable);
    } else if (size > 0 && data[0] == 1) {
      relume::mitsuba::read_obj(bytes.subspan(1), true, "fuzz.obj");
    } else {
      relume::fuzz::render_two_frames(relume::load_mitsuba_from_memory(bytes, "/nonexistent", "fuzz.xml"));
    }
  } catch (const relume::Error&) {
    // Expected for damaged input.
  }
  return 0;
}
