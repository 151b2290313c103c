// Errors of estimates of an image's error where frames reuse samples: the spread over seeds against estimates of one
// run, with correlations between frames and between pixels.
#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/frame_correlation.h"
#include "experiments/measure/ratio.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/named.h"
#include "experiments/shared_parts.h"
#include "metrics/estimate.h"
#include "render/session.h"
#include "report/images.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

constexpr const char* kOurs = "[relume]";
constexpr size_t kCorrelated = 41;  ///< 1 + 2 · cap, with the default cap of 20
constexpr const char* kReuse = "restir-di";

struct Mode {
  const char* name;
  const char* json;
  size_t correlated;  ///< frames that count as one
};

/// Neighbours are as far away, as a fraction of the image, as 30 pixels in images of 192 × 108.
constexpr Mode kModes[] = {
    {"ris", R"({"reuse": "ris"})", 1},
    {kReuse, R"({"reuse": "restir-di", "restir.radius": 10})", kCorrelated},
    {"frames only", R"({"reuse": "restir-di", "restir.neighbours": 0})", kCorrelated},
    {"pixels only", R"({"reuse": "restir-di", "restir.radius": 10, "restir.cap": 0})", 1},
    {"temporal feedback", R"({"reuse": "restir-di", "restir.radius": 10, "restir.feedback": "temporal"})", kCorrelated},
    {"cap 5", R"({"reuse": "restir-di", "restir.radius": 10, "restir.cap": 5})", 11},
};

struct Runs {
  std::vector<RunFrames> frames;  ///< luminance of the pixels of surfaces
  /// Layer `variance`, mean over the pixels: by run, by checkpoint.
  std::vector<std::vector<double>> estimates;
  Image mean;  ///< over all frames of the last run
};

/// Ratios of estimated standard errors to those over runs, after a number of frames.
struct Checkpoint {
  size_t frames = 0;
  double error = 0;   ///< over runs, relative to the mean light
  Ratio independent;  ///< as for independent frames
  Ratio estimated;    ///< by the layer `variance`
  Ratio batches;      ///< by blocks of kCorrelated frames; 0: too few
};

struct ModeResult {
  std::string name;
  size_t correlated = 1;
  std::vector<Checkpoint> checkpoints;
  std::vector<double> by_frame;  ///< correlations
  std::vector<double> by_pixel;
  Image mean;  ///< over one run
};

std::vector<size_t> checkpoints(const ExperimentContext& context) {
  if (context.quick) return {kCorrelated};
  return {kCorrelated, 2 * kCorrelated, 4 * kCorrelated, 8 * kCorrelated};
}

/// Pixels in which and beside which no lamp is visible: others vary with the lamp's share, whatever is reused. All
/// pixels if a small image has no such ones.
std::vector<size_t> surface_pixels(Session& session, const RenderSettings& base) {
  RenderSettings emission = base;
  emission.path.max_bounces = 0;
  session.set_settings(emission);
  for (int i = 0; i < 64; ++i) session.render_frame();
  const Image seen = session.image();
  const auto is_lamp = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < seen.width && y < seen.height && luminance(seen.at(x, y)) > 0;
  };
  std::vector<size_t> pixels;
  std::vector<size_t> all;
  for (int y = 0; y < seen.height; ++y) {
    for (int x = 0; x < seen.width; ++x) {
      bool lamp = false;
      for (int v = y - 1; v <= y + 1; ++v) {
        for (int u = x - 1; u <= x + 1; ++u) lamp = lamp || is_lamp(u, v);
      }
      all.push_back(static_cast<size_t>(y) * static_cast<size_t>(seen.width) + static_cast<size_t>(x));
      if (!lamp) pixels.push_back(all.back());
    }
  }
  return pixels.empty() ? all : pixels;
}

/// The frame's own values, from means before and after it.
std::vector<float> frame_values(const Image& before, const Image& after, size_t frames,
                                const std::vector<size_t>& pixels) {
  std::vector<float> values;
  const auto n = static_cast<double>(frames);
  for (const size_t p : pixels) {
    const double now = n * static_cast<double>(luminance(after.pixels[p]));
    const double then = frames > 1 ? (n - 1) * static_cast<double>(luminance(before.pixels[p])) : 0;
    values.push_back(static_cast<float>(now - then));
  }
  return values;
}

/// Variance of a pixel's mean as the session estimates it, averaged over the pixels.
double estimated_variance(const Session& session, const std::vector<size_t>& pixels) {
  const std::vector<float> variance = session.aov("variance").front().values;
  double sum = 0;
  for (const size_t p : pixels) sum += static_cast<double>(variance[p]);
  return sum / static_cast<double>(pixels.size());
}

/// Values of Runs for one run.
struct Run {
  RunFrames frames;
  std::vector<double> estimates;
  Image mean;
};
constexpr auto members_of(const Run*) { return std::tuple(&Run::frames, &Run::estimates, &Run::mean); }

Runs render(const ExperimentContext& context, Session& session, const Mode& mode, const std::vector<size_t>& pixels) {
  const std::vector<size_t> at = checkpoints(context);
  const auto measure = [&](const ExperimentContext& own, int seed) {
    session.restart(1 + seed);
    Run run;
    for (size_t frame = 1; frame <= at.back(); ++frame) {
      own.check_stop();
      session.render_frame();
      Image after = session.image();
      run.frames.push_back(frame_values(run.mean, after, frame, pixels));
      if (std::find(at.begin(), at.end(), frame) != at.end())
        run.estimates.push_back(estimated_variance(session, pixels));
      run.mean = std::move(after);
    }
    return run;
  };
  Runs runs;
  for (Run& run : deal_parts(context, mode.name, context.choose(24, 3), measure)) {
    runs.frames.push_back(std::move(run.frames));
    runs.estimates.push_back(std::move(run.estimates));
    runs.mean = std::move(run.mean);
  }
  return runs;
}

/// Root of the mean of `variances` over the root of the variance over runs, with an interval by leaving out each run.
Ratio ratio_of_errors(const std::vector<double>& variances, const std::vector<std::vector<double>>& means) {
  const auto ratio_without = [&](size_t left_out) {
    std::vector<std::vector<double>> some;
    double sum = 0;
    for (size_t r = 0; r < means.size(); ++r) {
      if (r == left_out) continue;
      some.push_back(means[r]);
      sum += variances[r];
    }
    const double actual = variance_over_runs(some);
    return actual > 0 ? std::sqrt(sum / static_cast<double>(some.size()) / actual) : 0;
  };
  Estimate estimate{ratio_without(means.size()), {}};
  for (size_t r = 0; r < means.size(); ++r) estimate.without.push_back(ratio_without(r));
  const double half = estimate.half_width();
  return {estimate.value, {std::max(estimate.value - half, 0.0), estimate.value + half, 0.95}};
}

Checkpoint checkpoint_of(const Runs& runs, size_t index, size_t frames) {
  const std::vector<std::vector<double>> means = run_means(runs.frames, frames);
  double light = 0;
  for (const std::vector<double>& run : means) {
    for (const double value : run) light += value / static_cast<double>(run.size() * means.size());
  }
  std::vector<double> single;
  std::vector<double> estimated;
  std::vector<double> batches;
  for (size_t r = 0; r < means.size(); ++r) {
    single.push_back(variance_by_blocks(runs.frames[r], frames, 1));
    estimated.push_back(runs.estimates[r][index]);
    if (frames >= 2 * kCorrelated) batches.push_back(variance_by_blocks(runs.frames[r], frames, kCorrelated));
  }
  Checkpoint result{.frames = frames,
                    .error = light > 0 ? std::sqrt(variance_over_runs(means)) / light : 0,
                    .independent = ratio_of_errors(single, means),
                    .estimated = ratio_of_errors(estimated, means),
                    .batches = {}};
  if (!batches.empty()) result.batches = ratio_of_errors(batches, means);
  return result;
}

ModeResult measure(const ExperimentContext& context, Session& session, const RenderSettings& base, const Mode& mode,
                   const std::vector<size_t>& pixels) {
  RenderSettings settings = base;
  settings_from_json(describe(settings), mode.json, mode.name);
  session.set_settings(settings);
  const Runs runs = render(context, session, mode, pixels);
  ModeResult result{.name = mode.name,
                    .correlated = mode.correlated,
                    .checkpoints = {},
                    .by_frame = {},
                    .by_pixel = {},
                    .mean = runs.mean};
  const std::vector<size_t> at = checkpoints(context);
  for (size_t i = 0; i < at.size(); ++i) result.checkpoints.push_back(checkpoint_of(runs, i, at[i]));
  result.by_frame =
      frame_correlations(runs.frames, context.quick ? 0 : kCorrelated, static_cast<size_t>(context.choose(120, 20)));
  result.by_pixel = pixel_correlations(runs.frames, pixels, static_cast<size_t>(base.width), 32);
  return result;
}

/// The sum of the correlations between a frame and all others: the frames that count as one.
double frames_as_one(const ModeResult& mode) {
  double sum = 1;
  for (size_t lag = 1; lag < mode.by_frame.size(); ++lag) {
    if (mode.by_frame[lag] < 0.01) break;  // noise from here on
    sum += 2 * mode.by_frame[lag];
  }
  return sum;
}

std::vector<const ModeResult*> reusing_frames(const std::vector<ModeResult>& modes) {
  std::vector<const ModeResult*> list;
  for (const ModeResult& mode : modes) {
    if (mode.correlated > 1) list.push_back(&mode);
  }
  return list;
}

/// Text of one ratio per checkpoint.
std::string by_checkpoint(const ModeResult& mode, Ratio Checkpoint::*ratio) {
  std::string text;
  for (const Checkpoint& c : mode.checkpoints) {
    if (!((c.*ratio).value > 0)) continue;
    text += fmt::format("{}{} after {} frames", text.empty() ? "" : ", ", share_text(c.*ratio), c.frames);
  }
  return text;
}

Claim claim_covers(const std::vector<ModeResult>& modes) {
  std::string measured;
  std::vector<Ratio> ratios;
  for (const ModeResult* mode : reusing_frames(modes)) {
    measured +=
        fmt::format("{}{}: {}", measured.empty() ? "" : "; ", mode->name, by_checkpoint(*mode, &Checkpoint::estimated));
    for (const Checkpoint& c : mode->checkpoints) ratios.push_back(c.estimated);
  }
  return judged_within("covers", kOurs, "The estimated standard error of correlated frames is no less than over seeds.",
                       measured, "at least 0.9 of that over seeds", ratios, 0.9);
}

Claim claim_tight(const std::vector<ModeResult>& modes) {
  const ModeResult& mode = named(modes, "mode", "frames only");
  std::vector<Ratio> ratios;
  for (const Checkpoint& c : mode.checkpoints) ratios.push_back(c.estimated);
  return judged_within("tight", kOurs, "Without neighbours, the estimated standard error is that over seeds.",
                       by_checkpoint(mode, &Checkpoint::estimated), "0.8 to 1.5 of that over seeds", ratios, 0.8, 1.5);
}

Claim claim_independent(const std::vector<ModeResult>& modes) {
  std::string measured;
  std::vector<Ratio> ratios;
  for (const ModeResult* mode : reusing_frames(modes)) {
    ratios.push_back(mode->checkpoints.back().independent);
    measured += fmt::format("{}{} {}", measured.empty() ? "" : ", ", mode->name, share_text(ratios.back()));
  }
  return judged_within("independent", kOurs,
                       "An estimate for independent frames has at most half of the standard error over seeds.",
                       measured, "at most 0.5 of that over seeds", ratios, 0, 0.5);
}

Claim claim_batches(const std::vector<ModeResult>& modes, const std::vector<size_t>& at) {
  const std::string text = fmt::format(
      "Means over blocks of {} frames give the standard error over seeds from {} frames on.", kCorrelated, at.back());
  const Checkpoint& last = named(modes, "mode", kReuse).checkpoints.back();
  const char* threshold = "0.8 to 1.25 of that over seeds";
  if (!(last.batches.value > 0)) return unmeasured("batches", kOurs, text, threshold, "a quick run has too few frames");
  return judged_within("batches", kOurs, text, by_checkpoint(named(modes, "mode", kReuse), &Checkpoint::batches),
                       threshold, {last.batches}, 0.8, 1.25);
}

Claim claim_sum(const std::vector<ModeResult>& modes) {
  std::string measured;
  bool holds = true;
  for (const ModeResult* mode : reusing_frames(modes)) {
    const double sum = frames_as_one(*mode);
    holds = holds && sum <= 1.1 * static_cast<double>(mode->correlated);
    measured += fmt::format("{}{} {:.1f} of {}", measured.empty() ? "" : ", ", mode->name, sum, mode->correlated);
  }
  return judged("frames-as-one", kOurs, "The correlations between a frame and all others sum to at most 1 + 2 · cap.",
                measured, "at most 1.1 times as much", holds);
}

TableBlock table(const std::vector<ModeResult>& modes) {
  TableBlock block{
      "Standard errors of the mean",
      "Relative standard error of a pixel over seeds, and estimates from one run over it: as for independent "
      "frames, by the layer variance (as --error), and by means over blocks of 41 frames. With 95 % "
      "intervals.",
      "mode and frames",
      {{"over seeds", "", Better::lower},
       {"independent", "", Better::none},
       {"layer variance", "", Better::none},
       {"blocks", "", Better::none}},
      {}};
  int color = 0;
  for (const ModeResult& mode : modes) {
    for (const Checkpoint& c : mode.checkpoints) {
      const auto cell = [](const Ratio& ratio) {
        return ratio.value > 0 ? TableCell{share_text(ratio), ratio.value} : TableCell{"–", {}};
      };
      block.rows.push_back({fmt::format("{}, {} frames", mode.name, c.frames),
                            color,
                            {{fmt::format("{:.2f} %", 100 * c.error), c.error},
                             cell(c.independent),
                             cell(c.estimated),
                             cell(c.batches)}});
    }
    ++color;
  }
  return block;
}

ChartBlock correlation_chart(const std::vector<ModeResult>& modes) {
  Chart frames{.label = "frames", .x_label = "frames apart", .y_label = "correlation", .curves = {}};
  Chart pixels{.label = "pixels", .x_label = "pixels apart", .y_label = "correlation", .curves = {}};
  int color = 0;
  const auto curve_of = [&](const ModeResult& mode, const std::vector<double>& values) {
    Curve curve{.name = mode.name, .color = color, .dashed = false, .points = {}};
    for (size_t lag = 0; lag < values.size(); ++lag) curve.points.push_back({static_cast<double>(lag), values[lag]});
    return curve;
  };
  for (const ModeResult& mode : modes) {
    frames.curves.push_back(curve_of(mode, mode.by_frame));
    pixels.curves.push_back(curve_of(mode, mode.by_pixel));
    ++color;
  }
  return {
      "Correlations",
      "Of a pixel's values in two frames, and of the errors of two pixels of a row in the last frame, about the mean "
      "over all seeds.",
      {std::move(frames), std::move(pixels)}};
}

ImageSet images(const std::vector<ModeResult>& modes) {
  std::vector<MeasuredImage> list;
  int color = 0;
  for (const ModeResult& mode : modes)
    list.push_back({mode.name, color++, &mode.mean, fmt::format("{:.1f} frames count as one", frames_as_one(mode))});
  return measured_set("warehouse", modes.front().mean, list, {.values = false});
}

ExperimentResult run_restir_correlation(const ExperimentContext& context) {
  const ExperimentScene scene = learning_scene("warehouse");
  RenderSettings base = scene.settings;
  base.width = context.choose(64, 16);
  base.height = context.choose(36, 9);
  base.device = context.device;
  base.path.max_bounces = 1;
  base.lights = LightSelectionChoice::light_tree;
  Session session(Scene(scene.scene), base);
  session.set_camera(scene.camera);
  const std::vector<size_t> pixels = surface_pixels(session, base);
  std::vector<ModeResult> modes;
  for (const Mode& mode : kModes) modes.push_back(measure(context, session, base, mode, pixels));

  ExperimentResult result;
  result.claims = {claim_independent(modes), claim_covers(modes), claim_tight(modes),
                   claim_batches(modes, checkpoints(context)), claim_sum(modes)};
  result.blocks.emplace_back(table(modes));
  result.blocks.emplace_back(correlation_chart(modes));
  result.blocks.emplace_back(
      ViewerBlock{"Images", "Means over one run; the reference is that of ris.", image_layer_kinds(), {images(modes)}});
  result.setup = {{"Scene", "warehouse, direct light; candidates of reservoirs come from the light tree"},
                  {"Size", fmt::format("{} × {}", base.width, base.height)},
                  {"Runs", fmt::format("{} seeds of {} frames each, from an empty history", context.choose(24, 3),
                                       checkpoints(context).back())},
                  {"Pixels", "those without a visible lamp in themselves or beside them"},
                  {"Intervals", "95 %, from the estimates without each of the seeds"}};
  return result;
}

}  // namespace

Experiment restir_correlation_experiment() {
  return {"restir-correlation", kOurs, "variance of the mean over frames that reuse samples: one run against seeds",
          run_restir_correlation};
}

}  // namespace relume
