// Comparison of contenders with a reference and with each other: at equal samples or equal time, on a still scene or
// along an animation.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "compare/contender.h"
#include "compare/reference.h"
#include "compare/shared_work.h"
#include "compare/timed_session.h"
#include "metrics/ensemble.h"

namespace relume {

struct ComparisonOptions {
  std::string scene_name;
  std::vector<Contender> contenders;
  std::vector<ImageContender> images;    ///< of the last frame
  SettingSources common;                 ///< for all contenders; the reference takes those that cannot bias it
  int spp = 64;                          ///< samples per pixel, per frame of an animation
  double budget_s = 0;                   ///< replaces spp: time per contender, for each frame of an animation
  int repetitions = 5;                   ///< with different seeds
  std::vector<float> times_s;            ///< frames of an animation; empty: the still scene
  std::filesystem::path reference_file;  ///< of the last frame; empty: rendered
  int reference_spp = 1024;
  SettingTexts reference_settings = {};  ///< for the rendered reference only
  std::filesystem::path cache_folder;
  std::string program = {};  ///< identifies the build: references of another build are rendered again
  FrameClock clock = {};     ///< measures the contenders' times; empty: wall_clock()
  bool keep_images = false;  ///< whether to keep the images of every repetition
  /// Whether times count at equal samples, too: contenders then alternate on one rank of each machine.
  bool timed = false;
  bool on_all_ranks = false;  ///< whether all ranks return the comparison, instead of the first one alone
};

inline bool is_animation(const ComparisonOptions& options) { return options.times_s.size() > 1; }

/// Error against the reference after a number of frames.
struct ErrorPoint {
  uint32_t frames = 0;
  double samples = 0;  ///< per pixel
  double time_s = 0;
  double mse = 0;
  double rel_mse = 0;
  double mape = 0;
  uint64_t nonfinite = 0;  ///< number of non-finite pixels, which the errors exclude
};

/// Measurements of one repetition.
struct Repetition {
  int seed = 0;
  uint32_t frames = 0;
  double samples = 0;  ///< per pixel, over all frames of an animation
  double time_s = 0;
  uint64_t rays = 0;
  double mse = 0;  ///< of the image; for an animation, the mean over its frames
  double rel_mse = 0;
  double mape = 0;
  double flip = 0;
  double temporal_error = 0;  ///< relative; only for animations
  uint64_t nonfinite = 0;     ///< non-finite pixels, excluded from the errors; over all frames of an animation
  /// Still scene: points during rendering. Animation: one point per frame, with `frames` counting from 1.
  std::vector<ErrorPoint> curve = {};
  std::vector<PassTime> passes = {};
};

/// A measured value of each repetition.
using Figure = std::function<double(const Repetition&)>;

struct ContenderResult {
  std::string name;
  bool is_image = false;  ///< external image: no times, and a single repetition
  std::string settings;   ///< JSON
  std::vector<std::pair<std::string, std::string>> differences = {};  ///< from the defaults
  std::vector<Repetition> repetitions = {};
  std::optional<ErrorSplit> split = {};  ///< of the last frame, from two repetitions on
  Image image = {};                      ///< of the first repetition, last frame
  std::vector<Image> images = {};        ///< of each repetition, if those are kept
};

/// Expected contribution of the reference's noise to the figures; for an animation, means over its frames. All 0:
/// unknown.
struct ReferenceNoise {
  double mse = 0;
  double rel_mse = 0;
  double temporal_error = 0;
};

struct Comparison {
  ComparisonOptions options;
  AllSettings reference_settings;
  SettingTexts reference_left_out = {};  ///< common flags that the reference ignored
  Reference reference;                   ///< of the last frame
  ReferenceNoise reference_noise = {};
  uint64_t reference_nonfinite = 0;  ///< number of its non-finite pixels; over all frames of an animation
  uint64_t scene_hash = 0;
  size_t triangles = 0;
  int threads = 0;           ///< 0: only images were compared
  int ranks = 1;             ///< that rendered at the same time
  double budget_spread = 0;  ///< EqualTime::spread() of the contenders; 0 at equal samples
  std::vector<ContenderResult> contenders;
  std::vector<std::string> notes;  ///< limits_of() the comparison
};

/// Called with "reference", "timing" or "contenders", and the completed fraction.
using ComparisonProgress = std::function<void(const std::string& stage, double fraction)>;

/// Runs the comparison. Returns std::nullopt if `stop` was requested first; the next call continues unfinished
/// references. Throws Error.
///
/// With `shared`, all of its ranks call this with equal arguments, and the first one returns the comparison, with the
/// images and errors of one process. Tasks are the halves of references, then the repetitions: at equal samples of one
/// contender, at equal time or if `timed` of all contenders in alternation, on one rank per machine.
std::optional<Comparison> compare(const Scene& scene, const ComparisonOptions& options, const std::stop_token& stop,
                                  const ComparisonProgress& progress, SharedWork* shared = nullptr);

/// Limits of the comparison, one sentence each.
std::vector<std::string> limits_of(const Comparison& comparison);

/// Milliseconds per frame.
double frame_ms(const Repetition& repetition);

/// The figure of each repetition, and its median.
std::vector<double> values_of(const ContenderResult& contender, const Figure& figure);
double median_of(const ContenderResult& contender, const Figure& figure);

/// Largest number of non-finite pixels in a repetition.
uint64_t most_nonfinite(const ContenderResult& contender);

/// Milliseconds per frame of each pass, medians over the repetitions. Requires a rendered contender.
std::vector<std::pair<std::string, double>> median_pass_ms(const ContenderResult& contender);

/// One object with everything except the images. `machine`: names and values that describe the machine.
std::string to_json(const Comparison& comparison, const std::vector<std::pair<std::string, std::string>>& machine);
/// One line per contender.
std::string to_csv(const Comparison& comparison);

}  // namespace relume
