#include "render/presets.h"

#include <string>

#include "core/error.h"
#include "settings/nearest_name.h"

namespace relume {

const std::vector<Preset>& presets() {
  static const std::vector<Preset> list = {
      {"preview", "A first look: few samples, few bounces (too dark where light takes many)",
       R"({"spp": 16, "max-bounces": 3, "estimator": "path", "lights": "power"})"},
      {"reference", "What other pictures are measured against: unbiased up to 64 bounces, many samples",
       R"({"spp": 4096, "max-bounces": 64, "path.russian-roulette": true, "estimator": "path", "lights": "power",
           "guide": "bsdf", "cache": "none", "allocation": "uniform", "history": "accumulate", "denoise": "none"})"},
      {"adaptive", "More samples where the noise is [Schalk18]", R"({"allocation": "adaptive"})"},
      {"reprojection", "Frames in motion: keeps what can be verified to be seen still [Schalk18]",
       R"({"history": "reproject"})"},
      {"combination", "Both: keeps what it can, and samples what is new or noisy [Schalk18]",
       R"({"allocation": "adaptive", "history": "reproject"})"},
  };
  return list;
}

const Preset& require_preset(std::string_view name) {
  std::vector<std::string> names;
  for (const Preset& preset : presets()) {
    if (preset.name == name) return preset;
    names.emplace_back(preset.name);
  }
  throw Error("there is no preset '" + std::string(name) + "'" + suggestion(name, names));
}

}  // namespace relume
