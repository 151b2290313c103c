// Fuzzes the readers of FBX, Collada, STL, 3DS and OFF: any bytes give a scene or an Error. The first byte selects the
// format.
#include <iterator>

#include "fuzz_assimp.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  constexpr const char* kFormats[] = {"fbx", "dae", "stl", "3ds", "off"};
  if (size > 0) read_by_assimp(data + 1, size - 1, kFormats[data[0] % std::size(kFormats)]);
  return 0;
}
