// Shared by `relume view` and `relume serve`: options, declaration and loading of the scene.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "render/settings.h"
#include "viewer/render/request.h"

namespace relume::cli {

struct ViewerOptions {
  std::string scene = "cornell";
  std::string preset;
  std::string settings_file;
  std::string ocio;  ///< "CONFIG:VIEW"; empty: the tone map
  float target_hz = 30;
  bool watch = true;                                       ///< reload the scene when its files change
  std::vector<std::pair<std::string, std::string>> flags;  ///< of settings
};

/// The command with its scene, `options`, and settings, but without name, summary, examples and run. `defaults` and the
/// variables of `options` live as long as the command.
Command viewer_command(ViewerOptions& viewer, AllSettings& defaults, std::vector<Option> options, Verbosity& verbosity);
/// Options of both commands. `ocio_help`: help of --ocio.
std::vector<Option> viewer_options(ViewerOptions& o, std::string_view ocio_help);

/// Sources of the settings, without the scene's own. Throws Error for invalid ones, before loading.
SettingSources setting_sources(const ViewerOptions& options);

/// The loaded scene and its settings at start.
struct ViewerStart {
  std::shared_ptr<const viewer::LoadedScene> scene;
  AllSettings settings;
  bool chooses_size = false;  ///< whether flags or a settings file choose the size of the image
};

/// Loads the scene on a thread of low priority. Calls `check`, unless empty, once the scene's files and settings are
/// known. Throws Error.
ViewerStart load_viewer_start(const ViewerOptions& options, SettingSources sources, const Verbosity& verbosity,
                              const std::function<void(const Scene&, const AllSettings&)>& check = {});

}  // namespace relume::cli
