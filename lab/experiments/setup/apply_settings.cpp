#include "experiments/setup/apply_settings.h"

#include "compare/contender.h"
#include "settings/setting.h"

namespace relume {

void apply_settings(std::string_view texts, std::string_view place, RenderSettings& settings) {
  const SettingList list = describe(settings);
  for (const auto& [name, text] : parse_settings(texts, place)) assign(require_setting(list, name, place), text, place);
}

}  // namespace relume
