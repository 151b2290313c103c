// Fuzzes the KTX2 reader: any bytes give an image or an Error.
#include <cstddef>
#include <cstdint>
#include <span>

#include "image/ktx2/ktx2.h"
#include "relume/error.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  try {
    relume::detail::decode_ktx2(bytes, "fuzz.ktx2");
  } catch (const relume::Error&) {
    // Expected for damaged input.
  }
  return 0;
}
