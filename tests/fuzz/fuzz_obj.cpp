// Fuzzes the OBJ reader: any bytes end in a scene or in an Error.
#include <cstddef>
#include <cstdint>
#include <span>

#include "core/error.h"
#include "io/assimp/assimp_loader.h"

/// assimp leaks when it gives up in the middle of a file. Under LeakSanitizer only this function is looked at.
extern "C" const char* __lsan_default_suppressions() { return "leak:libassimp"; }

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  try {
    relume::load_assimp_from_memory(bytes, "obj", "fuzz.obj");
  } catch (const relume::Error&) {
    // The expected answer to damaged input.
  }
  return 0;
}
