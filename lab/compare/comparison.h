// Contenders against a reference and against each other: at equal samples or equal time, on a still scene or along an
// animation.
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
#include "compare/timed_session.h"
#include "metrics/ensemble.h"

namespace relume {

struct ComparisonOptions {
  std::string scene_name;
  std::vector<Contender> contenders;
  std::vector<ImageContender> images;    ///< of the last frame
  SettingSources common;                 ///< for everybody; the reference takes what cannot bias it
  int spp = 64;                          ///< samples a pixel; of each frame of an animation
  double budget_s = 0;                   ///< instead of spp: time of each contender, in each frame of an animation
  int repetitions = 5;                   ///< with seeds of their own
  std::vector<float> times_s;            ///< frames of an animation; empty: the still scene
  std::filesystem::path reference_file;  ///< of the last frame; empty: rendered
  int reference_spp = 1024;
  SettingTexts reference_settings = {};  ///< of the rendered reference alone
  std::filesystem::path cache_folder;
  std::string program = {};  ///< tells builds apart: references of another one are rendered again
  FrameClock clock = {};     ///< by which contenders are timed; empty: wall_clock()
  bool keep_images = false;  ///< of every repetition
};

inline bool is_animation(const ComparisonOptions& options) { return options.times_s.size() > 1; }

/// How far an image is from the reference after some frames.
struct ErrorPoint {
  uint32_t frames = 0;
  double samples = 0;  ///< a pixel
  double time_s = 0;
  double mse = 0;
  double rel_mse = 0;
  double mape = 0;
  uint64_t nonfinite = 0;  ///< pixels that are not finite, which the errors leave out
};

/// What one repetition measured.
struct Repetition {
  int seed = 0;
  uint32_t frames = 0;
  double samples = 0;  ///< a pixel, all frames of an animation together
  double time_s = 0;
  uint64_t rays = 0;
  double mse = 0;  ///< of the image; of an animation, the mean over its frames
  double rel_mse = 0;
  double mape = 0;
  double flip = 0;
  double temporal_error = 0;  ///< relative; of an animation only
  uint64_t nonfinite = 0;     ///< pixels that are not finite, which the errors leave out; in all frames of an animation
  /// Still scene: while samples arrive. Animation: each of its frames, `frames` counting them from 1.
  std::vector<ErrorPoint> curve = {};
  std::vector<PassTime> passes = {};
};

/// A number that each repetition has.
using Figure = std::function<double(const Repetition&)>;

struct ContenderResult {
  std::string name;
  bool is_image = false;  ///< made elsewhere: has neither times nor repetitions beyond the one
  std::string settings;   ///< JSON
  std::vector<std::pair<std::string, std::string>> differences = {};  ///< from the defaults
  std::vector<Repetition> repetitions = {};
  std::optional<ErrorSplit> split = {};  ///< of the last frame, from two repetitions on
  Image image = {};                      ///< of the first repetition, last frame
  std::vector<Image> images = {};        ///< of each repetition, if those are kept
};

/// What noise of the reference adds to the figures on average; of an animation, means over its frames. All 0: not
/// known.
struct ReferenceNoise {
  double mse = 0;
  double rel_mse = 0;
  double temporal_error = 0;
};

struct Comparison {
  ComparisonOptions options;
  AllSettings reference_settings;
  SettingTexts reference_left_out = {};  ///< common flags that the reference did not take
  Reference reference;                   ///< of the last frame
  ReferenceNoise reference_noise = {};
  uint64_t reference_nonfinite = 0;  ///< pixels of it that are not finite; in all frames of an animation
  uint64_t scene_hash = 0;
  size_t triangles = 0;
  int threads = 0;           ///< 0: nothing was rendered, only images compared
  double budget_spread = 0;  ///< expected, of the times that whole frames add up to
  std::vector<ContenderResult> contenders;
  std::vector<std::string> notes;  ///< limits_of() it
};

/// "reference", "timing", "contenders" and the share that is done.
using ComparisonProgress = std::function<void(const std::string& stage, double fraction)>;

/// std::nullopt if `stop` was requested first; references that were begun go on next time. Throws Error.
std::optional<Comparison> compare(const Scene& scene, const ComparisonOptions& options, const std::stop_token& stop,
                                  const ComparisonProgress& progress);

/// What limits the comparison, one sentence each.
std::vector<std::string> limits_of(const Comparison& comparison);

/// Milliseconds a frame.
double frame_ms(const Repetition& repetition);

/// The figure of each repetition, and the median of that.
std::vector<double> values_of(const ContenderResult& contender, const Figure& figure);
double median_of(const ContenderResult& contender, const Figure& figure);

/// Pixels that are not finite, in the repetition that has most of them.
uint64_t most_nonfinite(const ContenderResult& contender);

/// Milliseconds a frame in each pass, medians over the repetitions. Requires a contender that was rendered.
std::vector<std::pair<std::string, double>> median_pass_ms(const ContenderResult& contender);

/// One object with everything but the images. `machine`: name and value of what the program knows about where it ran.
std::string to_json(const Comparison& comparison, const std::vector<std::pair<std::string, std::string>>& machine);
/// A line for each contender.
std::string to_csv(const Comparison& comparison);

}  // namespace relume
