#include "viewer/model/setting_rules.h"

#include "render/build_pipeline.h"

namespace relume::viewer {
namespace {

/// Whether `technique` is the choice's name, or one of several in it ("apsf+apg").
bool names(std::string_view choice, std::string_view technique) {
  if (choice == technique) return true;
  const size_t plus = choice.find('+');
  return plus != std::string_view::npos &&
         (choice.substr(0, plus) == technique || choice.substr(plus + 1) == technique);
}

}  // namespace

std::string refusal(const AllSettings& settings, const std::string& setting, std::string_view choice) {
  AllSettings wanted = settings;
  store(require_setting(describe(wanted), setting, setting), std::string(choice));
  return refusal(wanted.render);
}

std::string takes_effect_with(const AllSettings& settings, const std::string& setting) {
  const size_t dot = setting.find('.');
  if (dot == std::string::npos) return {};
  const std::string technique = setting.substr(0, dot);
  RenderSettings render = settings.render;
  if (technique == "path") return {};  // applies to every estimator
  if (technique == "psf") {            // shared by all caches except sharc
    if (render.cache == CacheChoice::none || render.cache == CacheChoice::sharc) return "cache = psf";
    // Denoisers trace separate edge rays.
    return setting == "psf.edge-rays" && render.denoise != DenoiseChoice::none ? "denoise = none" : std::string();
  }
  if (technique == "features")  // shared by all denoisers
    return render.denoise == DenoiseChoice::none ? "denoise = bmfr" : std::string();
  if (technique == "octree" && render.lights != LightSelectionChoice::vlc && render.guide != GuideChoice::cdq)
    return "lights = vlc or guide = cdq";
  std::string wanted;
  for (const Setting& slot : describe_slots(render)) {
    const auto* choice = std::get_if<ChoiceRef>(&slot.value);
    if (!choice) continue;
    for (size_t i = 0; i < choice->names.size(); ++i) {
      if (!names(choice->names[i], technique)) continue;
      if (*choice->value == static_cast<int>(i)) return {};
      if (wanted.empty()) wanted = slot.name + " = " + technique;
    }
  }
  return wanted;
}

}  // namespace relume::viewer
