// Options and execution of `relume render`: images, checkpoints, statistics.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "cli/command.h"

namespace relume::cli {

struct RenderOptions {
  std::string scene;
  std::string output;
  std::string aov;
  std::string crop;          ///< "X,Y,W,H"; empty: the whole image
  std::string ocio;          ///< "CONFIG:VIEW"; empty: the tone map
  std::string frames;        ///< empty: a single image
  std::string sample_range;  ///< "A-B"; empty: all samples
  float fps = 24;
  int warmup = 8;  ///< frames before a segment of a sequence on several ranks
  std::string preset;
  std::string settings_file;
  std::string stats;
  std::string checkpoint;  ///< empty: none
  float checkpoint_interval_s = 60;
  std::string display;                                     ///< empty: none
  std::vector<std::pair<std::string, std::string>> flags;  ///< of settings
};

/// Returns the exit code. Throws Error, before rendering wherever possible.
int run_render(const RenderOptions& options, const Verbosity& verbosity);

}  // namespace relume::cli
