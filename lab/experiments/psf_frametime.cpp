// [Schipek22 §6.2]: measures the time of a one-sample frame with two and ten levels of indirection, and with six the
// cost of psf and apg in Sponza, and of settings that may become defaults.
#include <cmath>
#include <ctime>
#include <memory>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "compare/timed_session.h"
#include "experiments/all.h"
#include "experiments/measure/ratio.h"
#include "experiments/setup/cache_scenes.h"
#include "experiments/setup/named.h"
#include "experiments/shared_parts.h"
#include "metrics/statistics.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Schipek22 §6.2]";
constexpr const char* kOurs = "[relume]";

/// Image size: in smaller images, costs that do not scale with pixels dominate.
int width_of(const ExperimentContext& context) { return context.choose(480, 96); }
int height_of(const ExperimentContext& context) { return context.choose(270, 54); }

/// Timings and statistics of one contender's frames.
struct FrameFigures {
  std::string name;
  double frame_ms = 0;                                 ///< median
  std::vector<double> frame_s;                         ///< frame_clock() per frame, in seconds
  std::vector<std::pair<std::string, double>> passes;  ///< wall-clock ms per frame
  double rays = 0;                                     ///< per pixel
  double cells = 0;
  double table_mb = 0;
  double probes = 0;
};

constexpr auto members_of(const FrameFigures*) {
  return std::tuple(&FrameFigures::name, &FrameFigures::frame_ms, &FrameFigures::frame_s, &FrameFigures::passes,
                    &FrameFigures::rays, &FrameFigures::cells, &FrameFigures::table_mb, &FrameFigures::probes);
}

struct Timing {
  std::string scene;
  int bounces = 0;
  std::vector<FrameFigures> list;
  double of(std::string_view name) const { return named(list, "contender", name).frame_ms; }
  Ratio ratio(std::string_view a, std::string_view b) const {
    return time_ratio(named(list, "contender", a).frame_s, named(list, "contender", b).frame_s);
  }
};
constexpr auto members_of(const Timing*) { return std::tuple(&Timing::scene, &Timing::bounces, &Timing::list); }

/// Warm-up frames, in which cells fill and their variance estimates become reliable.
int skipped_frames(const ExperimentContext& context) { return context.choose(24, 2); }
int counted_frames(const ExperimentContext& context) { return context.choose(24, 3); }

/// Processor time of all threads, in seconds: almost independent of other programs.
double processor_time(const Session&) { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// On a GPU, elapsed time: the host waits for it without using the processor.
FrameClock frame_clock(const ExperimentContext& context) {
  return context.measures_host() ? FrameClock(processor_time) : FrameClock(wall_clock);
}

double figure_of(const Session& session, std::string_view name) {
  for (const PassStatistic& figure : session.statistics().pass_statistics) {
    if (figure.name == name) return figure.value;
  }
  return 0;
}

/// Statistics before the counted frames.
struct Start {
  std::vector<PassTime> passes;
  uint64_t rays = 0;
};

FrameFigures figures_of(std::string name, const TimedSession& session, int skip, const Start& start, int pixels) {
  FrameFigures f{.name = std::move(name), .frame_s = {}, .passes = {}};
  f.frame_s.assign(session.frame_s().begin() + skip, session.frame_s().end());
  f.frame_ms = 1000 * median(f.frame_s);
  const auto counted = static_cast<double>(f.frame_s.size());
  for (const PassTime& pass : pass_times_since(session.passes(), start.passes))
    f.passes.emplace_back(pass.name, pass.seconds * 1000 / counted);
  f.rays = static_cast<double>(session.rays() - start.rays) / counted / pixels;
  f.cells = figure_of(session.session(), "cells.cells");
  f.table_mb = figure_of(session.session(), "cells.bytes") / 1e6;
  f.probes = figure_of(session.session(), "cells.probes");
  return f;
}

/// Measures contenders, which take turns frame by frame.
Timing measure_alone(const ExperimentContext& context, const ExperimentScene& scene, int bounces,
                     std::vector<NamedSettings> contenders) {
  Timing result{scene.name, bounces, {}};
  const int skip = skipped_frames(context);
  const int count = skip + counted_frames(context);
  std::vector<std::unique_ptr<TimedSession>> sessions;
  for (NamedSettings& contender : contenders) {
    contender.settings.path.max_bounces = bounces;
    contender.settings.width = width_of(context);
    contender.settings.height = height_of(context);
    context.check_stop();
    sessions.push_back(std::make_unique<TimedSession>(scene.scene, contender.settings, frame_clock(context)));
    sessions.back()->session().set_camera(scene.camera);
  }
  std::vector<Start> starts(sessions.size());
  for (int frame = 0; frame < count; ++frame) {
    for (size_t i = 0; i < sessions.size(); ++i) {
      context.check_stop();
      if (frame == skip) starts[i] = {sessions[i]->passes(), sessions[i]->rays()};
      sessions[i]->render_frame();
    }
    context.report(fmt::format("{}, {} bounces", scene.name, bounces), (frame + 1.0) / count);
  }
  const int pixels = width_of(context) * height_of(context);
  for (size_t i = 0; i < sessions.size(); ++i)
    result.list.push_back(figures_of(contenders[i].name, *sessions[i], skip, starts[i], pixels));
  return result;
}

/// The same on the first rank.
Timing measure(const ExperimentContext& context, const ExperimentScene& scene, int bounces,
               const std::vector<NamedSettings>& contenders) {
  return measure_on_first(context, fmt::format("{}, {} bounces", scene.name, bounces),
                          [&](const ExperimentContext& own) { return measure_alone(own, scene, bounces, contenders); });
}

/// Path tracing, psf, apsf, and apg with equal and with coarser cells beyond the first vertex. Path graphs have
/// relume's own feed.
std::vector<NamedSettings> cost_contenders(const ExperimentContext& context, const ExperimentScene& scene) {
  std::vector<NamedSettings> list = cache_contenders(context, scene);
  for (NamedSettings& contender : list) contender.settings.apg.feed = PathGraphSettings().feed;
  for (const int coarsening : {0, 2}) {
    NamedSettings contender{fmt::format("apg, deep-coarsening {}", coarsening), list.front().settings};
    contender.settings.cache = CacheChoice::apg;
    contender.settings.apg.deep_coarsening = coarsening;
    list.push_back(std::move(contender));
  }
  return list;
}

TableBlock table(const ExperimentContext& context, const std::vector<Timing>& timings) {
  const std::string_view kind =
      context.measures_host() ? "of processor time per frame, over all threads" : "per frame, elapsed";
  TableBlock block{"Times",
                   fmt::format("Median milliseconds {}; techniques take turns frame by frame.", kind),
                   "scene, bounces",
                   {},
                   {}};
  for (const FrameFigures& f : timings.front().list) block.columns.push_back({f.name});
  for (const Timing& t : timings) {
    TableRow row{.name = fmt::format("{}, {}", t.scene, t.bounces), .cells = {}};
    for (const FrameFigures& f : t.list) {
      row.cells.push_back({fmt::format("{:.1f}", f.frame_ms), f.frame_ms,
                           fmt::format("{:.2f}×", time_ratio(f.frame_s, t.list.front().frame_s).value)});
    }
    block.rows.push_back(std::move(row));
  }
  return block;
}

/// `title_end`: what distinguishes the table from another of the same scene.
TableBlock cost_table(const Timing& t, const char* title_end = "") {
  TableBlock block{fmt::format("{}, {} bounces{}", t.scene, t.bounces, title_end),
                   "Time as above, rays by frame; cells, table and probes after the last.",
                   "technique",
                   {{"time over path tracing's", "", Better::lower},
                    {"ms", "", Better::lower},
                    {"rays per pixel", "", Better::lower},
                    {"cells"},
                    {"table", "MB"},
                    {"probes"}},
                   {}};
  const auto cell = [](double value, int digits) { return TableCell{fmt::format("{:.{}f}", value, digits), value}; };
  for (const FrameFigures& f : t.list) {
    const double ratio = time_ratio(f.frame_s, t.list.front().frame_s).value;
    block.rows.push_back({.name = f.name,
                          .cells = {cell(ratio, 2), cell(f.frame_ms, 0), cell(f.rays, 2), cell(f.cells, 0),
                                    cell(f.table_mb, 0), cell(f.probes, 1)}});
  }
  return block;
}

BarBlock bars(const Timing& t) {
  BarBlock block{fmt::format("{}, {} bounces", t.scene, t.bounces), "Mean wall-clock time by pass.", "ms", {}};
  for (const FrameFigures& f : t.list) block.bars.push_back({f.name, f.passes});
  return block;
}

std::string ratios(const std::vector<Timing>& timings, std::string_view a, std::string_view b) {
  std::string text;
  for (const Timing& t : timings)
    text += fmt::format("{}{} {}: {}", text.empty() ? "" : ", ", t.scene, t.bounces, share_text(t.ratio(a, b)));
  return text;
}

/// Claim that the ratio of a's time to b's is within the bounds in all timings.
Claim claim_ratio(std::string id, std::string claim, const std::vector<Timing>& timings, std::string_view a,
                  std::string_view b, double low, double high, std::string threshold) {
  std::vector<Ratio> list;
  for (const Timing& t : timings) list.push_back(t.ratio(a, b));
  return judged_within(std::move(id), kPaper, std::move(claim),
                       fmt::format("{} over {}: {}", a, b, ratios(timings, a, b)), std::move(threshold), list, low,
                       high);
}

/// Difference of two medians; the noise is half of a 95 % interval.
struct Difference {
  double ms = 0;
  double noise_ms = 0;
};

Difference difference_ms(const Timing& t, std::string_view a, std::string_view b) {
  const auto half_width = [&](std::string_view name) {
    const Interval interval = median_interval(named(t.list, "contender", name).frame_s);
    return 1000 * (interval.high - interval.low) / 2;
  };
  return {t.of(a) - t.of(b), std::hypot(half_width(a), half_width(b))};
}

Claim claim_growth(const std::vector<Timing>& few, const std::vector<Timing>& many) {
  std::vector<const char*> verdicts;
  std::string measured;
  for (size_t i = 0; i < few.size(); ++i) {
    const Difference before = difference_ms(few[i], "apg", "path");
    const Difference after = difference_ms(many[i], "apg", "path");
    const double growth = after.ms - before.ms;
    const double noise = std::hypot(before.noise_ms, after.noise_ms);
    verdicts.push_back(verdict_of({growth - noise, growth + noise, 0.95}, 0));
    measured += fmt::format("{}{}: {:.1f} ± {:.1f} and {:.1f} ± {:.1f} ms", measured.empty() ? "" : ", ", few[i].scene,
                            before.ms, before.noise_ms, after.ms, after.noise_ms);
  }
  return with_verdict("graph-bounces", kPaper, "The cost of apg beyond path tracing grows with the number of bounces.",
                      measured + " beyond path tracing's with 2 and with 10 bounces",
                      "more with 10 in every scene, by the interval", verdict_of_all(verdicts));
}

/// Measures the relative cost of caches in Sponza with six bounces.
void measure_cost(const ExperimentContext& context, const ExperimentScene& scene, ExperimentResult& result) {
  const Timing t = measure(context, scene, 6, cost_contenders(context, scene));
  for (const char* name : {"psf", "apg"}) {
    const Ratio ratio = t.ratio(name, "path");
    result.claims.push_back(judged_within(fmt::format("cost-{}", name), kOurs,
                                          fmt::format("{}, 6 bounces: {} adds at most 20 % to path tracing's frame: "
                                                      "filling, eviction and filtering.",
                                                      scene.name, name),
                                          share_text(ratio) + " of path tracing's time", "at most 1.2", {ratio}, 0,
                                          1.2));
  }
  result.blocks.emplace_back(cost_table(t));
}

std::string option_id(const CacheOption& option, const std::string& scene) {
  return fmt::format("option-cost-{}-{}", option.name, scene);
}
std::string option_text(const CacheOption& option, const std::string& scene) {
  return fmt::format("{}, 6 bounces: {} takes at most {} of path tracing's time.", scene, option.name, option.max_time);
}
std::string option_threshold(const CacheOption& option) { return fmt::format("at most {}", option.max_time); }

/// Sponza and the mine; in a quick run the box.
bool times_options(const ExperimentContext& context, const ExperimentScene& scene) {
  return context.quick ? scene.name == "cornell" : scene.name == "Sponza" || scene.name == "mine";
}

/// Measures the costs of kCacheOptions beside those of the caches without them.
void measure_options(const ExperimentContext& context, const ExperimentScene& scene, ExperimentResult& result) {
  std::vector<NamedSettings> list = cache_contenders(context, scene);
  list.pop_back();  // apg+apsf is the basis of no option
  for (NamedSettings& contender : option_contenders(context, scene)) list.push_back(std::move(contender));
  for (NamedSettings& contender : list) contender.settings.apg.feed = PathGraphSettings().feed;
  const Timing t = measure(context, scene, 6, list);
  for (const CacheOption& option : kCacheOptions) {
    const Ratio path = t.ratio(option.name, "path");
    result.claims.push_back(judged_within(option_id(option, scene.name), kOurs, option_text(option, scene.name),
                                          fmt::format("{} of path tracing's time, {} of {}'s", share_text(path),
                                                      share_text(t.ratio(option.name, option.basis)), option.basis),
                                          option_threshold(option), {path}, 0, option.max_time));
  }
  result.blocks.emplace_back(cost_table(t, ": settings that may become defaults"));
}

std::vector<SponzaClaim> option_claims_about_sponza() {
  std::vector<SponzaClaim> list;
  for (const CacheOption& option : kCacheOptions)
    list.push_back({option_id(option, "Sponza"), option_text(option, "Sponza"), option_threshold(option)});
  return list;
}

ExperimentResult run_psf_frametime(const ExperimentContext& context) {
  std::vector<Timing> few;
  std::vector<Timing> many;
  ExperimentResult result;
  for (const ExperimentScene& scene : cache_scenes(context)) {
    few.push_back(measure(context, scene, 2, cache_contenders(context, scene)));
    many.push_back(measure(context, scene, 10, cache_contenders(context, scene)));
    if (scene.name == "Sponza") measure_cost(context, scene, result);
    if (times_options(context, scene)) measure_options(context, scene, result);
  }
  claim_without_sponza(context, kOurs,
                       {{"cost-psf", "Sponza, 6 bounces: psf adds at most 20 %.", "at most 1.2"},
                        {"cost-apg", "Sponza, 6 bounces: apg adds at most 20 %.", "at most 1.2"}},
                       result.claims);
  claim_without_sponza(context, kOurs, option_claims_about_sponza(), result.claims);
  std::vector<Timing> all = few;
  all.insert(all.end(), many.begin(), many.end());
  result.claims.push_back(claim_ratio("primary-faster", "apsf is faster than path tracing.", all, "apsf", "path", 0, 1,
                                      "ratio below 1 everywhere"));
  result.claims.push_back(claim_ratio(
      "filter-cost", "psf takes slightly longer than path tracing: filling, eviction and filtering add at most 20 %.",
      all, "psf", "path", 0, 1.2, "ratio at most 1.2 everywhere"));
  result.claims.push_back(
      claim_ratio("graph-slowest", "apg is slower than psf.", all, "apg", "psf", 1, 1e9, "ratio above 1 everywhere"));
  result.claims.push_back(claim_ratio("graph-with-primary", "apg is faster when combined with apsf.", all, "apg+apsf",
                                      "apg", 0, 1, "ratio below 1 everywhere"));
  result.claims.push_back(claim_growth(few, many));
  result.blocks.insert(result.blocks.begin(), table(context, all));
  for (const Timing& t : all) result.blocks.emplace_back(bars(t));
  result.setup = {{"Size", fmt::format("{} × {} (the paper: 1280 × 720)", width_of(context), height_of(context))},
                  {"Frames", fmt::format("{} after {} others", counted_frames(context), skipped_frames(context))},
                  {"Settings", "the defaults of each technique; apg.feed 1, as in the thesis, except with 6 bounces"}};
  return result;
}

}  // namespace

Experiment psf_frametime_experiment() {
  return {"psf-frametime", kPaper, "frame times of radiance caches", run_psf_frametime};
}

}  // namespace relume
