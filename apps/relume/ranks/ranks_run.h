// What the jobs of rank 0 share.
#pragma once

#include <stop_token>
#include <string>

#include "cli/render_setup.h"
#include "ranks/link.h"

namespace relume::ranks {

struct RanksRun {
  const cli::RenderOptions& options;
  const cli::Verbosity& verbosity;
  cli::RenderSetup& setup;
  RankLink& link;
  std::stop_token stop;
  std::string identity;
};

struct RanksEnd {
  int exit_code = 0;
  std::string problem = {};  ///< why the job ended early; empty: it did not
};

}  // namespace relume::ranks
