// Published figures and tables, measured again: what the paper claims beside what comes out here.
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <stop_token>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "metrics/statistics.h"
#include "report/page.h"

namespace relume {

/// Thrown out of an experiment when a stop was requested. References that were begun go on next time.
class ExperimentStopped : public std::exception {};

struct ExperimentContext {
  bool quick = false;                  ///< small images and few settings: shows that everything works
  std::filesystem::path cache_folder;  ///< for references
  std::filesystem::path scene_folder;  ///< holds sponza/sponza.gltf; empty: what needs it is left out
  /// Where what is measured stays until the experiment is complete, so that it goes on after an interruption; empty:
  /// nowhere.
  std::filesystem::path parts_folder = {};
  std::string program = {};  ///< tells builds of the program apart: another one measures everything again
  std::stop_token stop = {};
  std::function<void(const std::string& stage, double fraction)> progress = {};

  /// One of two numbers of samples, frames, repetitions, …
  int choose(int in_full, int in_quick) const { return quick ? in_quick : in_full; }
  /// Throws ExperimentStopped if a stop was requested.
  void check_stop() const {
    if (stop.stop_requested()) throw ExperimentStopped();
  }
  void report(const std::string& stage, double fraction) const {
    if (progress) progress(stage, fraction);
  }
};

struct ExperimentResult {
  std::vector<Claim> claims;
  std::vector<Block> blocks;                               ///< curves and images
  std::vector<std::pair<std::string, std::string>> setup;  ///< what was rendered, name and value
};

struct Experiment {
  std::string_view name;     ///< kebab-case
  std::string_view paper;    ///< key and place
  std::string_view summary;  ///< one line: what is tested
  ExperimentResult (*run)(const ExperimentContext& context);
};

/// All of them, in the order in which `relume experiment list` shows them.
const std::vector<Experiment>& experiments();

/// Throws Error, with the names that exist, if there is none of that name.
const Experiment& require_experiment(std::string_view name);

/// A claim whose verdict follows from `holds`.
Claim judged(std::string id, std::string paper, std::string claim, std::string measured, std::string threshold,
             bool holds);
/// Whether a value lies from `least` to `most`: holds or fails if its whole interval does, else it is undecided.
const char* verdict_of(const Interval& value, double least, double most = std::numeric_limits<double>::infinity());
/// Of a claim with several parts: fails if one fails, holds if there are any and all hold.
const char* verdict_of_all(const std::vector<const char*>& parts);
/// A claim with one of the kVerdict constants.
Claim with_verdict(std::string id, std::string paper, std::string claim, std::string measured, std::string threshold,
                   const char* verdict);
/// A claim for which something is missing; `reason` says what.
Claim unmeasured(std::string id, std::string paper, std::string claim, std::string threshold, std::string reason);

}  // namespace relume
