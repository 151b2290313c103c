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

namespace relume {
struct Comparison;
}

namespace relume::lab {

struct ComparisonRequest {
  /// "default,interactive,mine=preview,max-bounces:2": presets, techniques, settings files and settings, as
  /// `relume compare --techniques` takes them.
  std::string techniques = "default,interactive";
  std::vector<std::pair<std::string, std::string>> settings = {};  ///< name and value, for all contenders
  std::string scene_name = "scene";                                ///< in reports
  int spp = 64;                                                    ///< samples a pixel; of each frame of an animation
  double budget_s = 0;              ///< instead of `spp`: time of each contender, in each frame of an animation
  int repetitions = 5;              ///< with different seeds
  std::vector<float> times_s = {};  ///< frames of an animation; empty: the still scene
  std::filesystem::path reference_file = {};  ///< EXR; empty: the reference is rendered
  int reference_spp = 1024;                   ///< of the rendered reference
  std::filesystem::path cache_folder = {};    ///< keeps rendered references; required for them
};

/// Medians over the repetitions. Errors are against the reference, with its pixels that are not finite left out.
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

class ComparisonReport {
 public:
  explicit ComparisonReport(Comparison comparison);
  ~ComparisonReport();
  ComparisonReport(ComparisonReport&&) noexcept;
  ComparisonReport& operator=(ComparisonReport&&) noexcept;

  const std::vector<ContenderScore>& contenders() const { return contenders_; }
  const Image& reference() const;
  /// Expected MSE of the reference against the truth; 0 if it is not known.
  double reference_mse() const;
  /// What limits the comparison, one sentence each.
  const std::vector<std::string>& notes() const;

  std::string to_json() const;
  /// A line for each contender.
  std::string to_csv() const;
  /// A page for a browser, with the images.
  std::string to_html() const;

 private:
  std::unique_ptr<const Comparison> comparison_;
  std::vector<ContenderScore> contenders_;
};

/// Called with "reference", "timing" or "contenders", and the share of that stage that is done.
using StageProgress = std::function<void(const std::string& stage, double fraction)>;

/// Renders the reference, unless the cache has it, and the contenders. std::nullopt if `stop` was requested first; a
/// reference that was begun is continued next time. Throws Error for settings that do not exist or do not combine.
std::optional<ComparisonReport> compare(const Scene& scene, const ComparisonRequest& request, std::stop_token stop = {},
                                        const StageProgress& progress = {});

}  // namespace relume::lab
