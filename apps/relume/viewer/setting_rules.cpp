// What the interface can tell of settings without drawing anything.
#include "core/error.h"
#include "render/build_pipeline.h"
#include "viewer/settings_panel.h"

namespace relume::viewer {

std::string refusal(const Settings& settings, const std::string& setting, std::string_view choice) {
  Settings wanted = settings;
  try {
    store(require_setting(describe(wanted), setting, setting), std::string(choice));
    check_combination(wanted.render);
    return {};
  } catch (const Error& error) {
    return error.what();
  }
}

std::string takes_effect_with(const Settings& settings, const std::string& setting) {
  const size_t dot = setting.find('.');
  if (dot == std::string::npos) return {};
  const std::string technique = setting.substr(0, dot);
  RenderSettings render = settings.render;
  std::string wanted;
  for (const Setting& slot : describe_slots(render)) {
    const auto* choice = std::get_if<ChoiceRef>(&slot.value);
    if (!choice) continue;
    for (size_t i = 0; i < choice->names.size(); ++i) {
      if (choice->names[i] != technique) continue;
      if (*choice->value == static_cast<int>(i)) return {};
      wanted = slot.name + " = " + technique;
    }
  }
  return wanted;
}

}  // namespace relume::viewer
