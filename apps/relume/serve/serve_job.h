// Options and execution of `relume serve`.
#pragma once

#include <string>

#include "cli/command.h"
#include "cli/viewer_start.h"

namespace relume::cli {

struct ServeOptions : ViewerOptions {
  std::string bind = "127.0.0.1";  ///< numeric address
  int port = 8464;                 ///< 0: any free one
  std::string hosts;               ///< further names of the server, with commas between them
  int viewers = 8;                 ///< at the same time
};

/// Serves until SIGINT or SIGTERM. Returns the exit code. Throws Error.
int run_serve(const ServeOptions& options, const Verbosity& verbosity);

}  // namespace relume::cli
