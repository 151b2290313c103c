// The file and the images of a survey, which continues scene by scene.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "experiments/survey/survey.h"

namespace relume {

inline constexpr const char* kSurveyFile = "all.json";

/// Name of a technique's or scene's image without its extension: lower case, "-" in place of other characters.
std::string image_name(std::string_view name);

/// Identifies the conditions of a survey: program, device, greatest number of threads (0: all), techniques, effort.
std::string survey_key(const ExperimentContext& context, const std::vector<SurveyTechnique>& techniques,
                       const SurveyEffort& effort, int threads = 0);

/// all.json in a folder: {"key", "quick", "program", "device", "machine", "setup", "scenes"}. A scene: {"name",
/// "change", "seconds", "mean_square", "reference_mse", "reference_spp", "reference_settings", "image", "image_after",
/// "techniques"}. A technique: {"name", "settings", "slots"}, and "refused" or the fields of StillValues. If
/// "keeps_state", also "lag", "ghost", "ghost_error", "image_after". "failed" is the error that ended a technique: it
/// has the values measured before. Images are paths below the folder. A "lag" of null: the error has not settled.
/// Unknown errors are null.
class SurveyFile {
 public:
  /// Reads the file if it exists. Scenes that were measured under another key are dropped. Throws Error for a file that
  /// is no survey.
  SurveyFile(std::filesystem::path folder, std::string key);

  bool has(std::string_view scene) const;
  /// Number of scenes of another key that the file had.
  size_t dropped() const { return dropped_; }

  /// Adds the scene, and writes its images and the file. Throws Error.
  void add(const SceneValues& scene, double seconds, const ExperimentContext& context,
           const std::vector<std::pair<std::string, std::string>>& machine, const SurveyEffort& effort);

 private:
  std::filesystem::path folder_;
  std::string key_;
  size_t dropped_ = 0;
  std::vector<std::pair<std::string, std::string>> scenes_;  ///< name and JSON
};

}  // namespace relume
