// Fuzzes the EXR reader and the settings among the attributes: any bytes give an image with settings or an Error.
#include <cstddef>
#include <cstdint>
#include <span>

#include "relume/error.h"
#include "relume/image_io.h"
#include "render/settings.h"
#include "settings/settings_json.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span bytes(reinterpret_cast<const std::byte*>(data), size);
  try {
    const relume::ExrFile exr = relume::parse_exr(bytes, "fuzz.exr");
    relume::AllSettings settings;
    for (const auto& [name, text] : exr.attributes) {
      if (name == "relume.settings") relume::settings_from_json(relume::describe(settings), text, "fuzz.exr");
    }
    relume::image_from_exr(exr, "", "fuzz.exr");
  } catch (const relume::Error&) {
    // Expected for damaged input.
  }
  return 0;
}
