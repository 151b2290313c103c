// Reproduces published figures and tables, with the paper's claims and relume's results.
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

class SharedWork;

/// Thrown from an experiment on a stop request. Partial references are continued in the next run.
class ExperimentStopped : public std::exception {};

struct ExperimentContext {
  bool quick = false;                  ///< small images and few settings, to test the experiment
  std::filesystem::path cache_folder;  ///< for references
  std::filesystem::path scene_folder;  ///< contains sponza/sponza.gltf; empty: experiments skip it
  /// Folder for partial measurements, with which an interrupted experiment resumes; empty: none.
  std::filesystem::path parts_folder = {};
  std::string program = {};    ///< identifies the build; a new build invalidates partial measurements
  std::string device = "cpu";  ///< RenderSettings::device of the measured sessions and of references
  int threads = 0;             ///< threads at most, whatever the settings of a session; 0: no limit
  std::stop_token stop = {};
  std::function<void(const std::string& stage, double fraction)> progress = {};
  /// Ranks that all run the experiment and share its parts (shared_parts.h); nullptr: this process measures all.
  SharedWork* ranks = nullptr;

  /// Whether the setting chooses the processor.
  bool measures_host() const { return device == "cpu"; }
  /// Selects a number of samples, frames, repetitions, …
  int choose(int in_full, int in_quick) const { return quick ? in_quick : in_full; }
  /// Throws ExperimentStopped on a stop request.
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
  std::vector<std::pair<std::string, std::string>> setup;  ///< names and values of the test conditions
};

struct Experiment {
  std::string_view name;     ///< kebab-case
  std::string_view paper;    ///< citation key and section
  std::string_view summary;  ///< one line: the tested property
  ExperimentResult (*run)(const ExperimentContext& context);
};

/// All experiments, in the order of `relume experiment list`.
const std::vector<Experiment>& experiments();

/// Finds an experiment. Throws Error with the existing names if it is missing.
const Experiment& require_experiment(std::string_view name);

/// A claim whose verdict follows from `holds`.
Claim judged(std::string id, std::string paper, std::string claim, std::string measured, std::string threshold,
             bool holds);
/// Verdict on whether a value is in [least, most]: holds or fails if the whole interval does, otherwise undecided.
const char* verdict_of(const Interval& value, double least, double most = std::numeric_limits<double>::infinity());
/// Verdict on a claim with several parts: fails if one fails, holds if there are parts and all hold.
const char* verdict_of_all(const std::vector<const char*>& parts);
/// A claim with one of the kVerdict constants.
Claim with_verdict(std::string id, std::string paper, std::string claim, std::string measured, std::string threshold,
                   const char* verdict);
/// A claim that could not be measured because of `reason`.
Claim unmeasured(std::string id, std::string paper, std::string claim, std::string threshold, std::string reason);

}  // namespace relume
