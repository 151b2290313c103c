// Published figures and tables, measured again: the papers' claims beside what relume measures.
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
  std::string name;     ///< in kebab case
  std::string paper;    ///< key of the bibliography, and place
  std::string summary;  ///< one line
};

struct ExperimentRequest {
  bool quick = false;                       ///< small images and few settings
  std::filesystem::path cache_folder;       ///< keeps references
  std::filesystem::path scene_folder = {};  ///< holds sponza/sponza.gltf; empty: experiments leave Sponza out
  std::filesystem::path parts_folder = {};  ///< keeps measurements until the experiment is complete; empty: none
};

/// A claim of a paper, tested.
struct TestedClaim {
  std::string id;
  std::string paper;  ///< place
  std::string claim;
  std::string measured;
  std::string threshold;  ///< at which the claim holds
  std::string verdict;    ///< "holds", "does not hold", "undecided" or "not measured"
};

struct ExperimentReport {
  std::vector<TestedClaim> claims;
  double seconds = 0;
  std::string json;
  std::string html;  ///< a page for a browser
};

/// All experiments.
std::vector<ExperimentInfo> list_experiments();

/// Runs an experiment; many take hours unless `quick`. `progress` gets the stage and the share of it that is done.
/// std::nullopt if `stop` was requested first; with a `parts_folder` the next call continues. Throws Error for unknown
/// names.
std::optional<ExperimentReport> run_experiment(
    std::string_view name, const ExperimentRequest& request, std::stop_token stop = {},
    const std::function<void(const std::string& stage, double fraction)>& progress = {});

}  // namespace relume::lab
