// Options and execution of `relume view`.
#pragma once

#include <string>

#include "cli/command.h"
#include "cli/viewer_start.h"

namespace relume::cli {

struct ViewOptions : ViewerOptions {
  std::string script;      ///< file of steps; empty: none
  std::string screenshot;  ///< of the window, at the end; empty: none
  int smoke = 0;           ///< frames to render without showing a window; 0: an ordinary window
};

/// Returns the exit code. Throws Error.
int run_view(const ViewOptions& options, const Verbosity& verbosity);

}  // namespace relume::cli
