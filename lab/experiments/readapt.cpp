// Frames that stateful techniques need after a lamp, the camera or an object has moved, until their error is
// that of an adapted technique.
#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/adaptation.h"
#include "experiments/measure/learning_regions.h"
#include "experiments/measure/ratio.h"
#include "experiments/measure/settling.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/named.h"
#include "experiments/setup/references.h"
#include "metrics/statistics.h"
#include "render/session.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

constexpr const char* kOurs = "[relume]";

struct Technique {
  const char* name;
  const char* json;
  bool denoised = false;
  size_t frames = 0;       ///< claimed to suffice; 0: no claim
  const char* paper = "";  ///< source of that
};

/// Techniques without a denoiser show single frames.
constexpr Technique kContenders[] = {
    {"vlc", R"({"lights": "vlc", "history": "none"})", false, 11, "[Dittebrandt20 §7.2]"},
    {"neeat", R"({"lights": "neeat", "history": "none"})"},
    {"cdq", R"({"guide": "cdq", "history": "none"})", false, 20, "[Dittebrandt20 §7.3]"},
    {"mcls", R"({"lights": "mcls", "history": "none"})", false, 11, kOurs},
    {"mcpg", R"({"guide": "mcpg", "history": "none"})", false, 20, kOurs},
    {"restir-di", R"({"reuse": "restir-di", "history": "none"})", false, 20, kOurs},
    {"restir-gi", R"({"reuse": "restir-gi", "history": "none"})", false, 20, kOurs},
    {"sharc", R"({"cache": "sharc", "history": "none"})", false, 20, kOurs},
    {"mcpg", R"({"guide": "mcpg", "history": "none"})", false, 20, kOurs},
    {"restir-pt", R"({"reuse": "restir-pt", "history": "none"})", false, 20, kOurs},
    {"svgf", R"({"denoise": "svgf"})", true},
    {"asvgf", R"({"denoise": "asvgf"})", true, 8, kOurs},
};

/// A scene, and how to bring a session to its state before and after a change.
struct SceneChange {
  std::string id;    ///< of claims
  std::string text;  ///< "the lamp has turned by 36°"
  ExperimentScene before;
  ExperimentScene after;
  std::optional<Index> node = {};  ///< of the object that moves
};

SceneChange lamp_turns() {
  SceneChange change{"lamp", "the lamp has turned by 36°", learning_scene("turntable"), learning_scene("turntable")};
  change.after.settings.time_s = 1;
  return change;
}

SceneChange camera_turns(const ExperimentContext& context) {
  const char* scene = context.quick ? "cornell" : "warehouse";  // the former compiles fast
  SceneChange change{"camera", "the camera has turned by 30°", learning_scene(scene), learning_scene(scene)};
  change.after.camera = turned(change.after, 30);
  return change;
}

SceneChange box_moves() {
  SceneChange change{"object", "the tall box has moved by 0.6 m", learning_scene("cornell"), learning_scene("cornell")};
  Node& box = named(change.after.scene.nodes, "node", "tall box");
  box.transform.translation.x -= 0.6f;
  change.node = static_cast<Index>(&box - change.after.scene.nodes.data());
  return change;
}

void bring(Session& session, const ExperimentScene& state, const std::optional<Index>& node) {
  session.set_camera(state.camera);
  session.set_time(state.settings.time_s);
  if (node) session.set_transform(*node, state.scene.nodes[static_cast<size_t>(*node)].transform);
}

int runs_of(const ExperimentContext& context) { return context.choose(10, 2); }
int warm_up_of(const ExperimentContext& context) { return context.choose(40, 4); }
int frames_of(const ExperimentContext& context) { return context.choose(48, 24); }

Settling measure(const ExperimentContext& context, Session& session, const RenderSettings& base,
                 const Technique& contender, const SceneChange& change, const Reference& reference,
                 const PixelMask& region) {
  RenderSettings settings = base;
  settings_from_json(describe(settings), contender.json, contender.name);
  session.set_settings(settings);
  const auto change_at_first = [&](const ExperimentContext& own, Session& s, int frame) {
    if (frame > 0) return;
    for (int i = 0; i < warm_up_of(context); ++i) {
      own.check_stop();
      s.render_frame();
    }
    bring(s, change.after, change.node);
  };
  const std::string stage = fmt::format("{}, {}", change.id, contender.name);
  const auto begin = [&](Session& s) { bring(s, change.before, change.node); };
  Settling result{measure_adaptation(context, stage, session, runs_of(context), frames_of(context), reference, region,
                                     {.start = begin, .before = change_at_first})};
  if (contender.denoised) {
    const auto stay = [&](Session& s) { bring(s, change.after, change.node); };
    result.fresh = measure_adaptation(context, stage, session, runs_of(context), frames_of(context), reference, region,
                                      {.start = stay});
  }
  result.after.name = contender.name;
  result.fresh.name = fmt::format("{}, new session", contender.name);
  return result;
}

struct ChangeResult {
  SceneChange change;
  std::vector<Settling> cases;

  const Settling& of(std::string_view contender) const {
    return *std::find_if(cases.begin(), cases.end(), [&](const Settling& c) { return c.after.name == contender; });
  }
};

ChangeResult measure_change(const ExperimentContext& context, SceneChange change) {
  RenderSettings settings = change.before.settings;
  set_size_and_device(context, settings);
  const Reference reference = make_reference(context, plainly_sampled(change.after), context.choose(1024, 16));
  const PixelMask region = surfaces_of(context, change.after);
  std::vector<Index> movable;
  if (change.node) movable.push_back(*change.node);
  Session session(Scene(change.before.scene), settings, movable);
  ChangeResult result{std::move(change), {}};
  for (const Technique& contender : kContenders)
    result.cases.push_back(measure(context, session, settings, contender, result.change, reference, region));
  return result;
}

void claim_readapts(const ChangeResult& result, std::vector<Claim>& claims) {
  for (const Technique& contender : kContenders) {
    if (contender.frames == 0) continue;
    const Settling& c = result.of(contender.name);
    const size_t begin = contender.frames - 1;
    const Ratio ratio = over_settled(c, begin);
    claims.push_back(judged_within(
        fmt::format("{}-{}", result.change.id, contender.name), contender.paper,
        fmt::format("After {}, {} has settled within {} frames.", result.change.text, contender.name, contender.frames),
        fmt::format("{} of the settled error in the first frames, {} in frames {} to {}; within 10 % {}",
                    share_text(over_settled(c, 0)), share_text(ratio), contender.frames, begin + kFramesOfSettling,
                    settled_text(c)),
        fmt::format("at most {} of the settled error in {} frames from there on", kSettled, kFramesOfSettling), {ratio},
        0, kSettled));
  }
}

/// Mean of the first `count` frames, by runs.
std::vector<double> first_frames(const Adaptation& adaptation, size_t count) {
  std::vector<double> means;
  for (const std::vector<double>& run : adaptation.runs)
    means.push_back(mean({run.begin(), run.begin() + static_cast<std::ptrdiff_t>(std::min(count, run.size()))}));
  return means;
}

/// Claim that gradients shorten the lag: less error in the first frames than by blocks.
Claim claim_lag(const ChangeResult& result) {
  constexpr size_t kFirst = 8;
  const Ratio ratio =
      error_ratio(first_frames(result.of("svgf").after, kFirst), first_frames(result.of("asvgf").after, kFirst));
  return judged_ratios(
      fmt::format("{}-lag", result.change.id), "[Schied18]",
      fmt::format("In the {} frames after {}, asvgf has less error than svgf.", kFirst, result.change.text),
      to_text(ratio), {ratio}, 1);
}

TableBlock table(const std::vector<ChangeResult>& results) {
  TableBlock block{
      "Frames until the error has settled",
      fmt::format("First frame from which the mean of {} frames is within 10 % of the settled error, and the "
                  "error over that in the first {} frames. Settled: the last quarter of the frames; for "
                  "denoised images, a session that began after the change.",
                  kFramesOfSettling, kFramesOfSettling),
      "technique",
      {},
      {}};
  for (const ChangeResult& result : results)
    block.columns.push_back({"after " + result.change.text, "", Better::lower});
  int color = 0;
  for (const Technique& contender : kContenders) {
    TableRow row{.name = contender.name, .color = color++, .cells = {}};
    for (const ChangeResult& result : results) {
      const Settling& c = result.of(contender.name);
      const size_t frame = frames_until_settled(c);
      const size_t shown = frame > 0 ? frame : c.after.runs.front().size() + 1;
      row.cells.push_back({settled_text(c), static_cast<double>(shown), "first " + share_text(over_settled(c, 0))});
    }
    block.rows.push_back(std::move(row));
  }
  return block;
}

ExperimentResult run_readapt(const ExperimentContext& context) {
  std::vector<ChangeResult> results;
  results.push_back(measure_change(context, lamp_turns()));
  results.push_back(measure_change(context, camera_turns(context)));
  results.push_back(measure_change(context, box_moves()));
  ExperimentResult result;
  for (const ChangeResult& change : results) {
    claim_readapts(change, result.claims);
    if (change.change.id != "camera") result.claims.push_back(claim_lag(change));
  }
  result.blocks.emplace_back(table(results));
  for (const ChangeResult& change : results) {
    std::vector<Adaptation> single;
    std::vector<Adaptation> denoised;
    for (const Settling& c : change.cases) {
      (c.has_fresh() ? denoised : single).push_back(c.after);
      if (c.has_fresh()) denoised.push_back(c.fresh);
    }
    const std::string text = fmt::format(
        "Error after {}; frame 1 is the first. Bands are 95 % intervals of the mean over "
        "the runs.",
        change.change.text);
    result.blocks.emplace_back(adaptation_chart(change.change.id + ", single frames", text, single, 1));
    result.blocks.emplace_back(adaptation_chart(change.change.id + ", denoised", text, denoised, 1));
  }
  result.setup = {{"Size", size_text(context)},
                  {"Scenes", fmt::format("`turntable` (lamp), `{}` (camera), `cornell` (object); two indirect rays",
                                         results[1].change.before.name)},
                  {"Runs", fmt::format("{} seeds; {} frames before the change and {} after it, in which nothing moves",
                                       runs_of(context), warm_up_of(context), frames_of(context))},
                  {"Reference",
                   fmt::format("{} samples per pixel with the light tree, of the state after the change; its own noise "
                               "is known and subtracted",
                               context.choose(1024, 16))}};
  return result;
}

}  // namespace

Experiment readapt_experiment() {
  return {"readapt", kOurs, "frames until stateful techniques have adapted to a change", run_readapt};
}

}  // namespace relume
