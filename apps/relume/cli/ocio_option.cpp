#include "cli/ocio_option.h"

#include <fmt/format.h>

#include "cli/command.h"

namespace relume::cli {

std::string ocio_config(const std::string& option) { return option.substr(0, option.rfind(':')); }

std::shared_ptr<const OcioView> make_ocio_view(const std::string& option,
                                               const std::vector<std::pair<std::string, std::string>>& flags) {
  if (option.empty()) return nullptr;
  for (const auto& [name, value] : flags) {
    if (name == "tone-map") throw UsageError("--ocio replaces --tone-map; give one of them");
  }
  const size_t colon = option.rfind(':');
  if (colon == 0 || colon == option.npos || colon + 1 == option.size())
    throw UsageError(fmt::format(
        "--ocio is '{}', but must name a configuration and one of its views, such as config.ocio:Filmic", option));
  return std::make_shared<const OcioView>(ocio_config(option), option.substr(colon + 1));
}

}  // namespace relume::cli
