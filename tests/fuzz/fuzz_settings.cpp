// Fuzzes settings as JSON: any text gives settings or an Error. Valid settings must be equal after writing and reading.
#include <cstdint>
#include <cstdlib>
#include <string>
#include <string_view>

#include "relume/error.h"
#include "render/settings.h"
#include "settings/settings_json.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  relume::AllSettings settings;
  try {
    relume::settings_from_json(relume::describe(settings), text, "fuzz.json");
  } catch (const relume::Error&) {
    return 0;  // expected for damaged input
  }
  const std::string written = relume::settings_to_json(relume::describe(settings));
  relume::AllSettings again;
  relume::settings_from_json(relume::describe(again), written, "again.json");
  if (relume::settings_to_json(relume::describe(again)) != written) std::abort();
  return 0;
}
