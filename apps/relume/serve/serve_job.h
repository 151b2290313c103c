// Options and execution of `relume serve`.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "cli/command.h"

namespace relume::cli {

struct ServeOptions {
  std::string scene = "cornell";
  std::string preset;
  std::string settings_file;
  std::string ocio;                ///< "CONFIG:VIEW"; empty: the tone map
  std::string bind = "127.0.0.1";  ///< numeric address
  int port = 8464;                 ///< 0: any free one
  std::string hosts;               ///< further names of the server, with commas between them
  int viewers = 8;                 ///< at the same time
  float target_hz = 30;
  bool watch = true;                                       ///< reload the scene when its files change
  std::vector<std::pair<std::string, std::string>> flags;  ///< of settings
};

/// Serves until SIGINT or SIGTERM. Returns the exit code. Throws Error.
int run_serve(const ServeOptions& options, const Verbosity& verbosity);

}  // namespace relume::cli
