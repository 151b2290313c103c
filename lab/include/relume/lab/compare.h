// Comparison of techniques with a reference, at equal samples or equal time.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "relume/image.h"
#include "relume/scene.h"

namespace relume::lab {

/// A contender: a preset (empty: none) and settings in place of some of its values, as names and texts.
struct ContenderSettings {
  std::string name;
  std::string preset = {};
  std::vector<std::pair<std::string, std::string>> settings = {};
};

struct ComparisonRequest {
  /// "default,interactive,mine=preview,max-bounces:2": presets, techniques, settings files and settings, in the format
  /// of `relume compare --techniques`.
  std::string techniques = "default,interactive";
  std::vector<ContenderSettings> contenders = {};                  ///< replace `techniques` unless empty
  std::vector<std::pair<std::string, std::string>> settings = {};  ///< name and value, for all contenders
  std::string scene_name = "scene";                                ///< name in reports
  int spp = 64;                                                    ///< samples per pixel, per frame of an animation
  double budget_s = 0;                        ///< seconds per contender and frame of an animation; 0: `spp` applies
  int repetitions = 5;                        ///< with different seeds
  std::vector<float> times_s = {};            ///< scene times to compare, seconds; empty: the scene without animation
  std::filesystem::path reference_file = {};  ///< EXR; empty: renders the reference
  int reference_spp = 1024;                   ///< samples per pixel of a rendered reference
  std::filesystem::path cache_folder =
      {};  ///< folder of rendered references; required unless `reference_file` is given
};

/// Medians over the repetitions. Errors exclude pixels that are not finite in the image or the reference.
struct ContenderScore {
  std::string name;
  double mse = 0;  ///< mean squared error; for this and the next three see Metrics
  double rel_mse = 0;
  double mape = 0;
  double flip = 0;
  double temporal_error = 0;  ///< relative MSE of the error's change between frames (flicker); only for animations
  double samples = 0;         ///< per pixel
  double time_s = 0;
  std::vector<double> mses;  ///< one per repetition
  Image image;               ///< of the first repetition, last frame
};

/// Called with "reference", "timing" or "contenders", and the completed fraction of that stage.
using StageProgress = std::function<void(const std::string& stage, double fraction)>;

class ComparisonReport {
 public:
  ~ComparisonReport();
  ComparisonReport(ComparisonReport&&) noexcept;
  ComparisonReport& operator=(ComparisonReport&&) noexcept;

  const std::vector<ContenderScore>& contenders() const { return contenders_; }
  const Image& reference() const;
  /// Expected MSE of the reference against the true image; 0 if unknown.
  double reference_mse() const;
  /// Limits of the comparison, one sentence each.
  const std::vector<std::string>& notes() const;

  /// Scores and settings of the contenders.
  std::string to_json() const;
  /// One line per contender.
  std::string to_csv() const;
  /// An HTML page with the images.
  std::string to_html() const;

 private:
  friend std::optional<ComparisonReport> compare(const Scene& scene, const ComparisonRequest& request,
                                                 std::stop_token stop, const StageProgress& progress);
  struct State;
  explicit ComparisonReport(std::unique_ptr<const State> state);

  std::unique_ptr<const State> state_;
  std::vector<ContenderScore> contenders_;
};

/// Renders the contenders and, unless it is cached, the reference. Returns std::nullopt if `stop` was requested; the
/// next call continues the reference. Throws Error for unknown or incompatible settings.
std::optional<ComparisonReport> compare(const Scene& scene, const ComparisonRequest& request, std::stop_token stop = {},
                                        const StageProgress& progress = {});

}  // namespace relume::lab
