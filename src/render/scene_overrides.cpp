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

/// Whether `text` is three numbers with commas between them; they go to `rgb`.
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

}  // namespace

void apply(const SceneOverrides& overrides, Scene& scene) {
  const std::string& env = overrides.env;
  if (env.empty()) return;
  Environment environment;
  if (Rgb rgb(0); parse_rgb(env, rgb)) {
    for (int channel = 0; channel < 3; ++channel) {
      if (!(rgb[channel] >= 0 && rgb[channel] <= kMaxRadiance)) {
        throw Error("env: radiance " + env + " must be three numbers between 0 and 1e15");
      }
    }
    environment.kind = EnvironmentKind::constant;
    environment.color = rgb;
  } else if (env != "none") {
    if (std::error_code unknown; !std::filesystem::exists(env, unknown)) {
      throw Error("env: '" + env + "' is neither a radiance such as 1,1,1 nor none nor a file that exists");
    }
    load_environment_map(env, environment);
    environment.kind = EnvironmentKind::map;
  }
  scene.environment = std::move(environment);
}

}  // namespace relume
