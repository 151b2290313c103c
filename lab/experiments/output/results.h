// Writes the results of experiments: JSON and a page each, and an index page.
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/experiment.h"

namespace relume {

/// Metadata of the run.
struct ExperimentRun {
  std::vector<std::pair<std::string, std::string>> machine;
  bool quick = false;
  double seconds = 0;
  bool scenes = true;          ///< with ExperimentContext::scene_folder
  std::string program = {};    ///< ExperimentContext::program
  std::string device = "cpu";  ///< ExperimentContext::device
};

/// {"name", "paper", "summary", "quick", "seconds", "scenes", "program", "device", "machine", "setup", "claims":
/// [{"id", "paper", "claim", "measured", "threshold", "verdict"}], "tables": [{"title", "columns", "rows"}], "curves"}.
/// A row is a list of its name and its cells, with notes in brackets. Bars are stored as tables of their parts.
std::string to_json(const Experiment& experiment, const ExperimentResult& result, const ExperimentRun& run);

/// Page with the claims, followed by the experiment's blocks.
Page experiment_page(const Experiment& experiment, const ExperimentResult& result, const ExperimentRun& run);

/// An experiment's entry in the index.
struct ExperimentSummary {
  std::string name;
  std::string paper;
  std::string summary;
  ExperimentRun run;
  std::vector<Claim> claims;
};

/// Reads the output of to_json(). Throws Error that begins with `place` if it is invalid.
ExperimentSummary read_summary(std::string_view json, const std::string& place);

/// Index page with all claims and links to NAME.html in the same folder.
Page index_page(const std::vector<ExperimentSummary>& experiments);

/// The same claims as Markdown tables, without links.
std::string index_markdown(const std::vector<ExperimentSummary>& experiments);

}  // namespace relume
