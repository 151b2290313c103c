#include "render/settings.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include <fmt/format.h>

#include "files/extension.h"
#include "relume/error.h"
#include "relume/image_io.h"
#include "render/aov_reference.h"
#include "render/presets.h"
#include "scene/compiled_scene.h"
#include "settings/nearest_name.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

SettingList concatenate(std::initializer_list<SettingList> lists) {
  SettingList result;
  for (const SettingList& list : lists) result.insert(result.end(), list.begin(), list.end());
  return result;
}

/// Applies the settings stored in an image, to reproduce it.
void apply_image_settings(const SettingList& list, const std::string& file) {
  const ExrFile exr = read_exr(file);
  const auto attribute = exr.attributes.find("relume.settings");
  if (attribute == exr.attributes.end()) {
    throw Error(file +
                ": the image has no attribute 'relume.settings'; only EXR files that relume wrote have settings");
  }
  settings_from_json(list, attribute->second, file);
}

std::vector<std::string_view> tone_map_choices() {
  std::vector<std::string_view> names(kToneMapNames.begin(), kToneMapNames.end());
  names.emplace_back("auto");
  return names;
}

}  // namespace

SettingList describe(SceneOverrides& s) {
  return {{"env", &s.env,
           "Environment, instead of the scene's: studio, sky, sun_sky, none, radiance R,G,B, or an equirectangular EXR "
           "or HDR file; empty: the scene's, or studio if nothing lights the visible surfaces"},
          {"env-rotation",
           &s.env_rotation_deg,
           "Rotation of the environment about the vertical axis",
           {.min = -360, .max = 360, .unit = "degrees"}},
          {"env-exposure",
           &s.env_exposure,
           "Exposure of the environment: its radiance is multiplied by 2 to this power",
           {.min = -64, .max = 64, .unit = "stops"}},
          {"variant", &s.variant, "Name of a material variant in the scene file; empty: the default materials"}};
}

SettingList describe(StopSettings& s) {
  return {
      {"spp",
       &s.spp,
       "Samples per pixel, on average; 0: 64, or no limit if --time or --error is set",
       {.min = 0, .max = 1 << 30, .resets_history = false}},
      {"time",
       &s.time_s,
       "Render time after which no further sample starts (10s, 500ms, 2min); 0: no limit",
       {.min = 0, .max = 1e8, .unit = "s", .resets_history = false}},
      {"error",
       &s.error,
       "Estimated relative error of the image at which rendering stops, such as 0.02; 0: no limit",
       {.min = 0, .max = 1e6, .resets_history = false}},
  };
}

SettingList describe(OutputSettings& s) {
  return {
      {"exposure",
       OptionalNumberRef{&s.exposure, "auto"},
       "Exposure of PNG and JPEG files and displays: radiance is multiplied by 2 to this power; auto: metered from the "
       "image",
       {.min = -64, .max = 64, .unit = "stops", .resets_history = false}},
      {"tone-map",
       choice(s.tone_map, tone_map_choices()),
       "Tone mapping of PNG and JPEG files and displays to [0, 1]; none: clip; auto: neutral under the studio "
       "environment, agx otherwise",
       {.resets_history = false}},
  };
}

std::vector<SettingGroup> setting_groups(AllSettings& s) {
  return {
      {"Image", "Size, view, sampling and environment.", concatenate({describe_image(s.render), describe(s.scene)}),
       SettingGroupRole::image},
      {"When to stop", "Rendering stops at the first limit that is reached.", describe(s.stop),
       SettingGroupRole::stopping},
      {"Light transport", "`--max-bounces` and `--path.russian-roulette` apply to every estimator.",
       describe_transport(s.render)},
      {"Radiance caches", "`psf` applies to all caches except `sharc`; the others only to the caches of their names.",
       describe_caches(s.render)},
      {"Frames", "The firefly clamp, adaptive sampling and reprojection.", describe_frames(s.render)},
      {"Denoisers", "Surface features and the denoisers BMFR, SVGF and A-SVGF.", describe_denoisers(s.render)},
      {"Slots", "One technique per slot; docs/combinations.md shows which combine.", describe_slots(s.render),
       SettingGroupRole::slots},
      {"Display", "For 8-bit files and displays; EXR and HDR files store linear radiance.", describe(s.output)},
  };
}

SettingList describe(AllSettings& settings) { return flatten(setting_groups(settings)); }

namespace {

/// The setting as a command-line flag.
std::string as_flag(const Setting& setting) {
  if (const auto* flag = std::get_if<bool*>(&setting.value)) return (**flag ? "--" : "--no-") + setting.name;
  return fmt::format("--{} {}", setting.name, to_string(setting));
}

}  // namespace

std::string settings_reference() {
  AllSettings defaults;
  std::string text =
      "# Settings\n\n<!-- Made by `relume settings --markdown` from the declarations in the code; a test compares. "
      "-->\n\nEvery setting is a flag (`relume render scene.glb --max-bounces 4`), a key in settings "
      "files\n(`--settings file.json` with `{\"max-bounces\": 4}`) and part of the metadata of every EXR. "
      "Later\nsources override earlier ones: defaults, settings in the scene file, `--preset`, `--settings`,\nflags. "
      "`--settings image.exr` reads the settings with which an EXR was rendered. `--name` and\n`--no-name` switch a "
      "true-or-false setting.\n\n*Resets*: a change discards the accumulated frames. *Biases*: some values change the "
      "expected\nimage.\n";
  text += settings_to_markdown(setting_groups(defaults));
  text +=
      "\n## Presets\n\nThe table lists the differences from the defaults. `adaptive`, `reprojection` and "
      "`combination`\nchange only the listed settings and keep the others as the scene file sets them. All other "
      "presets\nset every slot, to its default where nothing is listed.\n\n| `--preset` | use | settings "
      "|\n|---|---|---|\n";
  for (const Preset& preset : presets()) {
    AllSettings changed;
    settings_from_json(describe(changed), preset.json, preset.name);
    std::string values;
    const SettingList list = describe(changed);  // the result contains pointers into it
    for (const Setting* setting : differing_settings(list, describe(defaults))) {
      values += fmt::format("{}`{}`", values.empty() ? "" : " ", as_flag(*setting));
    }
    text += fmt::format("| `{}` | {} | {} |\n", preset.name, preset.summary, values);
  }
  return text + aov_reference();
}

AllSettings resolve(const SettingSources& sources, AllSettings settings) {
  const SettingList list = describe(settings);
  if (!sources.scene_json.empty()) settings_from_json(list, sources.scene_json, sources.scene_place);
  if (!sources.preset.empty())
    settings_from_json(list, require_preset(sources.preset).json, "preset " + sources.preset);
  if (!sources.file.empty()) {
    const bool image = lower_extension(sources.file) == ".exr";
    image ? apply_image_settings(list, sources.file) : settings_from_file(list, sources.file);
  }
  for (const auto& [name, text] : sources.flags) {
    Setting flag = require_setting(list, name, "--" + name);
    flag.name.insert(0, "--");  // for messages, in the user's spelling
    assign(flag, text, "");
  }
  return settings;
}

void fit_to_camera(AllSettings& settings, const SettingSources& sources, const Scene& scene) {
  const Index node = find_camera(scene, settings.render.camera);
  if (node == kNone) return;
  const float ratio = scene.cameras[static_cast<size_t>(scene.nodes[static_cast<size_t>(node)].camera)].aspect_ratio;
  AllSettings nothing;
  nothing.render.width = nothing.render.height = 0;
  const RenderSettings given = resolve(sources, nothing).render;
  if (ratio == 0 || (given.width > 0 && given.height > 0)) return;
  int& width = settings.render.width;
  int& height = settings.render.height;
  const auto pixels = [](float n) { return std::clamp(static_cast<int>(std::lround(n)), 1, 32768); };
  const bool keeps_width = given.width > 0 || (given.height == 0 && ratio >= 1.0f);
  if (keeps_width) {
    height = pixels(static_cast<float>(width) / ratio);
  } else {
    if (given.height == 0) height = width;
    width = pixels(static_cast<float>(height) * ratio);
  }
}

}  // namespace relume
