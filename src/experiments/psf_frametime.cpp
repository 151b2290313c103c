// [Schipek22 §6.2]: time of a frame of one sample a pixel, with two and with ten levels of indirection.
#include <algorithm>
#include <ctime>

#include <fmt/format.h>

#include "compare/timed_session.h"
#include "experiments/all.h"
#include "experiments/frame_averages.h"
#include "experiments/trace.h"
#include "metrics/statistics.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Schipek22 §6.2]";

struct Timing {
  std::string scene;
  int bounces = 0;
  std::vector<std::string> names;
  std::vector<double> frame_ms;                                     ///< medians of processor time
  std::vector<std::vector<std::pair<std::string, double>>> passes;  ///< ms a frame, of a clock on the wall
  double of(std::string_view name) const {
    return frame_ms[static_cast<size_t>(std::find(names.begin(), names.end(), name) - names.begin())];
  }
};

/// Seconds that all threads of this program have worked: other programs hardly count.
double processor_time(const Session&) { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

Timing measure(const ExperimentContext& context, const ExperimentScene& scene, int bounces) {
  Timing result{scene.name, bounces, {}, {}, {}};
  const int skip = context.choose(24, 4);
  const int count = context.choose(100, 8);
  std::vector<std::unique_ptr<TimedSession>> sessions;
  for (CacheContender& contender : cache_contenders(context, scene)) {
    contender.settings.path.max_bounces = bounces;
    context.check_stop();
    sessions.push_back(std::make_unique<TimedSession>(scene.scene, contender.settings, processor_time));
    sessions.back()->session().set_camera(scene.camera);
    result.names.push_back(contender.name);
  }
  for (int frame = 0; frame < skip + count; ++frame) {
    context.check_stop();
    for (auto& session : sessions) session->render_frame();
    context.report(fmt::format("{}, {} bounces", scene.name, bounces), (frame + 1.0) / (skip + count));
  }
  for (auto& session : sessions) {
    result.frame_ms.push_back(1000 * median({session->frame_s().begin() + skip, session->frame_s().end()}));
    result.passes.push_back(session->passes());
    for (auto& [name, seconds] : result.passes.back()) seconds *= 1000.0 / session->frames();
  }
  return result;
}

TableBlock table(const std::vector<Timing>& timings) {
  TableBlock block{
      "Times",
      "Median milliseconds of processor time a frame, all threads together; techniques take turns frame by frame.",
      "scene, bounces",
      {},
      {}};
  for (const std::string& name : timings.front().names) block.columns.push_back({name});
  for (const Timing& t : timings) {
    TableRow row{.name = fmt::format("{}, {}", t.scene, t.bounces), .cells = {}};
    for (const double ms : t.frame_ms)
      row.cells.push_back({fmt::format("{:.1f}", ms), ms, fmt::format("{:.2f}×", ms / t.frame_ms.front())});
    block.rows.push_back(std::move(row));
  }
  return block;
}

BarBlock bars(const Timing& t) {
  BarBlock block{fmt::format("{}, {} bounces", t.scene, t.bounces), "Mean by pass, by a clock on the wall.", "ms", {}};
  for (size_t i = 0; i < t.names.size(); ++i) block.bars.push_back({t.names[i], t.passes[i]});
  return block;
}

std::string ratios(const std::vector<Timing>& timings, std::string_view a, std::string_view b) {
  std::string text;
  for (const Timing& t : timings)
    text += fmt::format("{}{} {}: {:.2f}", text.empty() ? "" : ", ", t.scene, t.bounces, t.of(a) / t.of(b));
  return text;
}

/// Holds if the ratio of a's time to b's keeps to the bounds everywhere.
Claim claim_ratio(std::string id, std::string claim, const std::vector<Timing>& timings, std::string_view a,
                  std::string_view b, double low, double high, std::string threshold) {
  bool holds = true;
  for (const Timing& t : timings) {
    const double ratio = t.of(a) / t.of(b);
    holds = holds && ratio >= low && ratio <= high;
  }
  return judged(std::move(id), kPaper, std::move(claim), fmt::format("{} over {}: {}", a, b, ratios(timings, a, b)),
                std::move(threshold), holds);
}

Claim claim_growth(const std::vector<Timing>& few, const std::vector<Timing>& many) {
  bool holds = true;
  std::string measured;
  for (size_t i = 0; i < few.size(); ++i) {
    const double before = few[i].of("apg") - few[i].of("path");
    const double after = many[i].of("apg") - many[i].of("path");
    holds = holds && after > before;
    measured += fmt::format("{}{}: {:.1f} ms and {:.1f} ms", measured.empty() ? "" : ", ", few[i].scene, before, after);
  }
  return judged("graph-bounces", kPaper, "What apg costs beyond path tracing grows with the number of bounces.",
                measured + " beyond path tracing's with 2 and with 10 bounces", "more with 10 in every scene", holds);
}

ExperimentResult run_psf_frametime(const ExperimentContext& context) {
  std::vector<Timing> few;
  std::vector<Timing> many;
  for (const ExperimentScene& scene : cache_scenes(context)) {
    few.push_back(measure(context, scene, 2));
    many.push_back(measure(context, scene, 10));
  }
  std::vector<Timing> all = few;
  all.insert(all.end(), many.begin(), many.end());
  ExperimentResult result;
  result.claims.push_back(claim_ratio("primary-faster", "apsf is faster than path tracing.", all, "apsf", "path", 0, 1,
                                      "ratio below 1 everywhere"));
  result.claims.push_back(claim_ratio("filter-cost",
                                      "psf takes a little longer than path tracing: filling, eviction and filtering "
                                      "add at most 20 %.",
                                      all, "psf", "path", 0, 1.2, "ratio at most 1.2 everywhere"));
  result.claims.push_back(
      claim_ratio("graph-slowest", "apg is slower than psf.", all, "apg", "psf", 1, 1e9, "ratio above 1 everywhere"));
  result.claims.push_back(claim_ratio("graph-with-primary", "apg is faster together with apsf.", all, "apg+apsf", "apg",
                                      0, 1, "ratio below 1 everywhere"));
  result.claims.push_back(claim_growth(few, many));
  result.blocks.emplace_back(table(all));
  for (const Timing& t : all) result.blocks.emplace_back(bars(t));
  result.setup = {common_setup(context).front(),
                  {"Frames", context.quick ? "8 after 4 others" : "100 after 24 others"},
                  {"Settings", "the defaults of each technique"}};
  return result;
}

}  // namespace

Experiment psf_frametime_experiment() {
  return {"psf-frametime", kPaper, "what frames of caches cost", run_psf_frametime};
}

}  // namespace relume
