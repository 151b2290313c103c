// Published figures and tables, reproduced: the papers' claims beside relume's measurements.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

namespace relume::lab {

struct ExperimentInfo {
  std::string name;     ///< kebab-case
  std::string paper;    ///< key of the bibliography and location in the paper
  std::string summary;  ///< one line
};

struct ExperimentRequest {
  bool quick = false;                       ///< small images and few settings
  std::filesystem::path cache_folder;       ///< folder for references
  std::filesystem::path scene_folder = {};  ///< contains sponza/sponza.gltf; empty: experiments omit Sponza
  std::filesystem::path parts_folder = {};  ///< stores measurements until the experiment is complete; empty: none
  std::string device = "cpu";               ///< the setting "device" of all sessions
};

/// A tested claim of a paper.
struct TestedClaim {
  std::string id;
  std::string paper;  ///< location in the paper
  std::string claim;
  std::string measured;
  std::string threshold;  ///< condition under which the claim holds
  std::string verdict;    ///< "holds", "does not hold", "undecided" or "not measured"
};

struct ExperimentReport {
  std::vector<TestedClaim> claims;
  double seconds = 0;
  std::string json;
  std::string html;  ///< an HTML page
};

/// All experiments.
std::vector<ExperimentInfo> list_experiments();

/// Runs an experiment; many take hours unless `quick`. `progress` receives the stage and its completed fraction.
/// Returns std::nullopt if `stop` was requested first; with a `parts_folder`, the next call continues. Throws Error for
/// unknown names, and if the device is unknown or cannot be used.
std::optional<ExperimentReport> run_experiment(
    std::string_view name, const ExperimentRequest& request, std::stop_token stop = {},
    const std::function<void(const std::string& stage, double fraction)>& progress = {});

}  // namespace relume::lab
