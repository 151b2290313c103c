// What experiments leave behind: JSON and a page each, and a page that leads to them.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/experiment.h"

namespace relume {

/// What is known of the run beside the result.
struct ExperimentRun {
  std::vector<std::pair<std::string, std::string>> machine;
  bool quick = false;
  double seconds = 0;
  bool scenes = true;        ///< with ExperimentContext::scene_folder
  std::string program = {};  ///< ExperimentContext::program
};

/// {"name", "paper", "summary", "quick", "seconds", "scenes", "program", "machine", "setup", "claims": [{"id", "paper",
/// "claim", "measured", "threshold", "verdict"}], "tables": [{"title", "columns", "rows"}], "curves"}; a row is a list
/// of its name and its cells, with notes in brackets. Bars are tables of their parts.
std::string to_json(const Experiment& experiment, const ExperimentResult& result, const ExperimentRun& run);

/// Claims first, what the experiment shows after them.
Page experiment_page(const Experiment& experiment, const ExperimentResult& result, const ExperimentRun& run);

/// What an index tells of an experiment that was run.
struct ExperimentSummary {
  std::string name;
  std::string paper;
  std::string summary;
  ExperimentRun run;
  std::vector<Claim> claims;
};

/// From what to_json() wrote. Throws Error that begins with `place` if it is something else.
ExperimentSummary read_summary(std::string_view json, const std::string& place);

/// A page that leads to those of experiments, which stand beside it as NAME.html, with all their claims.
Page index_page(const std::vector<ExperimentSummary>& experiments);

/// The same claims as tables in Markdown, without links.
std::string index_markdown(const std::vector<ExperimentSummary>& experiments);

}  // namespace relume
