#include "render/aov_reference.h"

#include <map>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "render/aov.h"
#include "render/build_pipeline.h"
#include "settings/setting.h"

namespace relume {
namespace {

struct Layer {
  std::string help;
  std::vector<std::string> choices;  ///< choices that add the layer; empty: every frame has it
};

using Layers = std::map<std::string, Layer>;

/// Adds the layers that `settings` have beyond the default.
void add_layers(const RenderSettings& settings, const std::string& choice, Layers& layers) {
  for (const AovLayer& layer : aov_layers(plan(settings))) {
    const auto [at, is_new] = layers.try_emplace(layer.name, Layer{layer.help, {}});
    if (choice.empty() || (!is_new && at->second.choices.empty())) continue;
    at->second.choices.push_back(choice);
  }
}

/// Layers of every choice of every slot, with all other settings at their defaults.
Layers all_layers() {
  Layers layers;
  RenderSettings plain;
  plain.auxiliary = true;
  add_layers(plain, "", layers);
  RenderSettings names;
  for (const Setting& slot : describe_slots(names)) {
    for (const std::string_view value : std::get<ChoiceRef>(slot.value).names) {
      if (value == "oidn") continue;  // optional at build time, so not on this page
      RenderSettings settings;
      settings.cdq.view = true;
      const SettingList slots = describe_slots(settings);
      assign(require_setting(slots, slot.name, "layers"), value, slot.name);
      add_layers(settings, fmt::format("`--{} {}`", slot.name, value), layers);
    }
  }
  RenderSettings caustics;
  caustics.estimator = EstimatorChoice::bdpt;
  caustics.denoise = DenoiseChoice::svgf;
  caustics.bdpt.caustic_layer = true;
  for (const AovLayer& layer : aov_layers(plan(caustics)))
    layers.try_emplace(layer.name, Layer{layer.help, {"`--bdpt.caustic-layer`"}});
  return layers;
}

}  // namespace

std::string aov_reference() {
  std::string text =
      "\n## Layers\n\nLayers that `--aov` writes into an EXR beside the image, and that the viewer's inspector "
      "shows.\n\n| `--aov` | contents | with |\n|---|---|---|\n";
  for (const auto& [name, layer] : all_layers())
    text += fmt::format("| `{}` | {} | {} |\n", name, layer.help, fmt::join(layer.choices, ", "));
  return text;
}

}  // namespace relume
