// Options and execution of `relume view`.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "cli/command.h"

namespace relume::cli {

struct ViewOptions {
  std::string scene = "cornell";
  std::string preset;
  std::string settings_file;
  std::string ocio;        ///< "CONFIG:VIEW"; empty: the tone map
  std::string script;      ///< file of steps; empty: none
  std::string screenshot;  ///< of the window, at the end; empty: none
  int smoke = 0;           ///< frames to render without showing a window; 0: an ordinary window
  float target_hz = 30;
  bool watch = true;                                       ///< reload the scene when its files change
  std::vector<std::pair<std::string, std::string>> flags;  ///< of settings
};

/// Returns the exit code. Throws Error.
int run_view(const ViewOptions& options, const Verbosity& verbosity);

}  // namespace relume::cli
