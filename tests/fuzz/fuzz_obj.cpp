// Fuzzes the OBJ reader: any bytes give a scene or an Error.
#include "fuzz_assimp.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  read_by_assimp(data, size, "obj");
  return 0;
}
