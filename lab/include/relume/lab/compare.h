// Techniques against a reference, at equal samples or equal time.
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

struct ComparisonRequest {
  /// "default,interactive,mine=preview,max-bounces:2": presets, techniques, settings files and settings, as
  /// `relume compare --techniques` takes them.
  std::string techniques = "default,interactive";
  std::vector<std::pair<std::string, std::string>> settings = {};  ///< name and value, for all contenders
  std::string scene_name = "scene";                                ///< in reports
  int spp = 64;                                                    ///< samples a pixel; of each frame of an animation
  double budget_s = 0;              ///< seconds for each contender, in each frame of an animation; 0: `spp` decides
  int repetitions = 5;              ///< with different seeds
  std::vector<float> times_s = {};  ///< scene times to compare, seconds; empty: the scene without animation
  std::filesystem::path reference_file = {};  ///< EXR; empty: the reference is rendered
  int reference_spp = 1024;                   ///< samples a pixel of a rendered reference
  std::filesystem::path cache_folder =
      {};  ///< where rendered references are kept; required unless `reference_file` is given
};

/// Medians over the repetitions. Errors leave out pixels that are not finite in the image or in the reference.
struct ContenderScore {
  std::string name;
  double mse = 0;
  double rel_mse = 0;
  double mape = 0;
  double flip = 0;
  double temporal_error = 0;  ///< relative; of an animation only
  double samples = 0;         ///< a pixel
  double time_s = 0;
  std::vector<double> mses;  ///< of each repetition
  Image image;               ///< of the first repetition, last frame
};

/// Called with "reference", "timing" or "contenders", and the share of that stage that is done.
using StageProgress = std::function<void(const std::string& stage, double fraction)>;

class ComparisonReport {
 public:
  ~ComparisonReport();
  ComparisonReport(ComparisonReport&&) noexcept;
  ComparisonReport& operator=(ComparisonReport&&) noexcept;

  const std::vector<ContenderScore>& contenders() const { return contenders_; }
  const Image& reference() const;
  /// Expected MSE of the reference against the truth; 0 if it is not known.
  double reference_mse() const;
  /// Limits of the comparison, one sentence each.
  const std::vector<std::string>& notes() const;

  std::string to_json() const;
  /// A line for each contender.
  std::string to_csv() const;
  /// A page for a browser, with the images.
  std::string to_html() const;

 private:
  friend std::optional<ComparisonReport> compare(const Scene& scene, const ComparisonRequest& request,
                                                 std::stop_token stop, const StageProgress& progress);
  struct State;
  explicit ComparisonReport(std::unique_ptr<const State> state);

  std::unique_ptr<const State> state_;
  std::vector<ContenderScore> contenders_;
};

/// Renders the contenders and, unless the cache has it, the reference. Returns std::nullopt if `stop` was requested;
/// the next call continues the reference. Throws Error for settings that do not exist or do not combine.
std::optional<ComparisonReport> compare(const Scene& scene, const ComparisonRequest& request, std::stop_token stop = {},
                                        const StageProgress& progress = {});

}  // namespace relume::lab
