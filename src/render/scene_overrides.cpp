#include <charconv>
#include <cmath>
#include <filesystem>
#include <string_view>

#include "relume/error.h"
#include "relume/scene_io.h"
#include "render/settings.h"
#include "scene/scene.h"

namespace relume {
namespace {

/// Parses three comma-separated numbers into `rgb`; returns whether it succeeded.
bool parse_rgb(std::string_view text, Rgb& rgb) {
  const char* position = text.data();
  const char* const end = text.data() + text.size();
  for (int channel = 0; channel < 3; ++channel) {
    while (position != end && *position == ' ') ++position;
    const auto [next, failure] = std::from_chars(position, end, rgb[channel]);
    if (failure != std::errc{}) return false;
    position = next;
    if (channel < 2 && (position == end || *position++ != ',')) return false;
  }
  return position == end;
}

/// The environment named `env`. Throws Error.
Environment named_environment(const std::string& env) {
  Environment environment;
  if (env == "studio") {
    environment.kind = EnvironmentKind::studio;
  } else if (env == "none") {
    environment.kind = EnvironmentKind::none;
  } else if (env == "sky" || env == "sun_sky") {
    environment.kind = EnvironmentKind::sun_sky;
    if (env == "sky") environment.sun_sky.sun_scale = 0;
  } else if (Rgb rgb(0); parse_rgb(env, rgb)) {
    for (int channel = 0; channel < 3; ++channel) {
      if (!(rgb[channel] >= 0 && rgb[channel] <= kMaxRadiance))
        throw Error("env: radiance " + env + " must be three numbers between 0 and 1e15");
    }
    environment.kind = EnvironmentKind::constant;
    environment.color = rgb;
  } else {
    if (std::error_code unknown; !std::filesystem::exists(env, unknown)) {
      throw Error("env: cannot find file '" + env +
                  "'; give an existing one, a radiance such as 1,1,1, or studio, sky, sun_sky or none");
    }
    load_environment_map(env, environment);
  }
  return environment;
}

}  // namespace

void apply_to_scene(const Settings& settings, Scene& scene) { apply(all_settings(settings).scene, scene); }

void apply(const SceneOverrides& overrides, Scene& scene) {
  if (!overrides.variant.empty()) choose_variant(scene, overrides.variant);
  Environment& environment = scene.environment;
  if (!overrides.env.empty()) environment = named_environment(overrides.env);
  environment.rotation_rad += glm::radians(overrides.env_rotation_deg);
  environment.color = glm::min(environment.color * std::exp2(overrides.env_exposure), Rgb(kMaxRadiance));
}

}  // namespace relume
