// [Dittebrandt20 §7.3]: measures how fast quadtrees adapt to a sudden change in light direction.
#include <algorithm>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/adaptation.h"
#include "experiments/measure/learning_modes.h"
#include "experiments/measure/learning_regions.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/references.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Dittebrandt20 §7.3]";
constexpr const char* kOurs = "[relume]";
constexpr float kDegreesPerSecond = 36;  // speed of the turntable
constexpr float kTurns[] = {9, 36};      // degrees

/// A quadtree variant: lasting, or the paper's with this number of bits and migrations.
struct Variation {
  int bits = 128;
  int migrations = 1;
  bool lasting = false;
  const LearningMode* mode = nullptr;  ///< added to it; nullptr: none

  bool operator==(const Variation&) const = default;
  std::string name() const {
    const std::string base = lasting
                                 ? "lasting quadtrees"
                                 : fmt::format("{} bits, {} migration{}", bits, migrations, migrations == 1 ? "" : "s");
    return mode ? with_mode(base, *mode) : base;
  }
};
constexpr Variation kAsInThePaper = {};
constexpr Variation kLasting = {.lasting = true};

struct Case {
  float degrees;
  Variation variation;
  Adaptation adaptation;  ///< frame 0 is the first one after the change
};

/// Reference after the change, and the pixels for errors.
struct Goal {
  Reference reference;
  PixelMask region;
};

/// A scene, its session, and its settings without guiding.
struct Turning {
  ExperimentScene scene;
  RenderSettings settings;
  Session session;
};

Turning turning(const ExperimentContext& context, const char* name) {
  const ExperimentScene scene = learning_scene(name);
  RenderSettings settings = scene.settings;
  set_size_and_device(context, settings);
  settings.history = HistoryChoice::none;
  Turning result{scene, settings, Session(Scene(scene.scene), settings)};
  result.session.set_camera(scene.camera);
  return result;
}

/// Adapts to the lamp's first position, moves it, and measures the following frames in each of `runs` runs.
Case measure(const ExperimentContext& context, Session& session, const RenderSettings& base, const Goal& goal,
             float degrees, const Variation& variation, int runs) {
  RenderSettings settings = base;
  settings.guide = GuideChoice::cdq;
  if (variation.lasting) {
    use_lasting_quadtrees(settings);
  } else {
    settings.cdq.bits = static_cast<QuadtreeBits>(variation.bits / 32 - 1);
    settings.cdq.migrations = variation.migrations;
  }
  if (variation.mode) variation.mode->apply(settings);
  session.set_settings(settings);
  Case result{degrees, variation, {}};
  const int warm_up = context.choose(128, 8);
  const auto prepare = [&](const ExperimentContext& own, Session& s, int frame) {
    if (frame > 0) return;
    for (int i = 0; i < warm_up; ++i) {
      own.check_stop();
      s.render_frame();
    }
    s.set_time(degrees / kDegreesPerSecond);
  };
  const std::string stage = fmt::format("{:.0f}°, {}", degrees, variation.name());
  result.adaptation = measure_adaptation(context, stage, session, runs, context.choose(64, 28), goal.reference,
                                         goal.region, {.start = [](Session& s) { s.set_time(0); }, .before = prepare});
  result.adaptation.name = variation.name();
  return result;
}

Goal goal_after(const ExperimentContext& context, ExperimentScene scene, float degrees) {
  scene.settings.time_s = degrees / kDegreesPerSecond;
  return {make_reference(context, plainly_sampled(scene), learning_reference_spp(context)),
          surfaces_of(context, scene)};
}

const Case& find(const std::vector<Case>& cases, float degrees, const Variation& variation) {
  return *std::find_if(cases.begin(), cases.end(),
                       [&](const Case& c) { return c.degrees == degrees && c.variation == variation; });
}

void claim_readapts(const Adaptation& adaptation, const char* prefix, float degrees, size_t frames,
                    const std::string& suffix, const char* source, std::vector<Claim>& claims) {
  claims.push_back(judged_adapted(
      fmt::format("{}readapts-{:.0f}{}", prefix, degrees, suffix), source,
      fmt::format("After {:.0f}° the trees ({}) readapt in about {} frames.", degrees, adaptation.name, frames),
      adaptation, frames));
}

void claim_speed(const std::vector<Case>& cases, float degrees, size_t frames, std::vector<Claim>& claims) {
  const Adaptation& one = find(cases, degrees, kAsInThePaper).adaptation;
  claim_readapts(one, "", degrees, frames, "", kPaper, claims);
  claim_readapts(find(cases, degrees, kLasting).adaptation, "", degrees, frames, "-lasting", kOurs, claims);
  const Adaptation& many = find(cases, degrees, {128, 8}).adaptation;
  const Ratio after_one = one.over_plateau(0, frames);
  const Ratio after_many = many.over_plateau(0, frames);
  const Ratio ratio = quotient(after_many, after_one);
  claims.push_back(judged_within(
      fmt::format("faster-{:.0f}", degrees), "[Dittebrandt20 §8]", "Several migrations per frame readapt faster.",
      fmt::format("after {:.0f}° {} of its plateau's MSE in the first {} frames with eight, {} with one: {} of it",
                  degrees, share_text(after_many), frames, share_text(after_one), share_text(ratio)),
      "below 1", {ratio}, 0, 1));
}

void claim_bits(const std::vector<Case>& cases, const Adaptation& bsdf, std::vector<Claim>& claims) {
  std::string measured;
  for (const int bits : {32, 64, 96, 128}) {
    const double plateau = find(cases, 36, {bits, 1}).adaptation.plateau(16);
    measured += fmt::format("{}{} bits {:.3g}", measured.empty() ? "" : ", ", bits, plateau);
  }
  const Adaptation& many = find(cases, 36, kAsInThePaper).adaptation;
  const Ratio ratio = error_ratio(find(cases, 36, {64, 1}).adaptation.plateaus(16), many.plateaus(16));
  claims.push_back(with_verdict("bits", kPaper, "More than 64 bits do not lower the error much.",
                                fmt::format("MSE {}; 64 bits over 128: {}", measured, to_text(ratio)),
                                "64 bits at most 1.15× of 128, by the interval", verdict_of(ratio.interval, 0, 1.15)));
  const Ratio peak = error_ratio(many.at(0), bsdf.plateaus(bsdf.runs.front().size()));
  claims.push_back(with_verdict(
      "bounded", kPaper,
      "Directly after 36° the error exceeds that of BSDF sampling; the fraction of BSDF samples limits it.",
      fmt::format("{} of the BSDF's MSE", to_text(peak)), "between 1 and 2.2, by the interval",
      verdict_of(peak.interval, 1, 2.2)));
}

/// The turntable with bits and migrations. `bsdf`: BSDF sampling after the larger turn.
std::vector<Case> measure_wide(const ExperimentContext& context, Adaptation& bsdf) {
  Turning table = turning(context, "turntable");
  const int runs = context.choose(16, 2);
  std::vector<Case> cases;
  for (const float degrees : kTurns) {
    const Goal goal = goal_after(context, table.scene, degrees);
    const auto add = [&](const Variation& variation) {
      cases.push_back(measure(context, table.session, table.settings, goal, degrees, variation, runs));
    };
    if (degrees > 20) {
      RenderSettings plain = table.settings;
      plain.time_s = degrees / kDegreesPerSecond;
      table.session.set_settings(plain);
      bsdf = measure_adaptation(context, "BSDF", table.session, runs, 4, goal.reference, goal.region);
    }
    for (const int bits : {32, 64, 96, 128}) {
      if (degrees > 20 || bits % 64 == 0) add({bits, 1});
    }
    add(kLasting);
    for (const int migrations : {2, 4, 8}) {
      if (degrees > 20 || migrations == 8) add({128, migrations});
    }
  }
  return cases;
}

/// The turntable with a narrow beam, whose lit patch is small as in the paper: errors of the floor alone.
std::vector<Case> measure_spot(const ExperimentContext& context) {
  Turning table = turning(context, "turntable-spot");
  std::vector<Case> cases;
  for (const float degrees : kTurns) {
    Goal goal = goal_after(context, table.scene, degrees);
    goal.region = pixels_of_material(context, table.scene, "floor");
    const auto add = [&](const Variation& variation, int runs) {
      cases.push_back(measure(context, table.session, table.settings, goal, degrees, variation, runs));
    };
    add(kAsInThePaper, context.choose(64, 2));
    add(kLasting, context.choose(64, 2));
    for (const LearningMode& mode : modes_to_measure(context, guiding_modes()))
      add({.mode = &mode}, context.choose(16, 2));
  }
  return cases;
}

/// Mean MSE of the first frames, by runs.
std::vector<double> early(const Adaptation& adaptation, size_t frames) {
  std::vector<double> means;
  for (const std::vector<double>& run : adaptation.runs)
    means.push_back(mean({run.begin(), run.begin() + static_cast<std::ptrdiff_t>(std::min(frames, run.size()))}));
  return means;
}

void claim_spot(const ExperimentContext& context, const std::vector<Case>& cases, std::vector<Claim>& claims) {
  constexpr std::pair<float, size_t> kBounds[] = {{9.0f, 10}, {36.0f, 20}};
  for (const auto& [degrees, frames] : kBounds) {
    const Adaptation& paper = find(cases, degrees, kAsInThePaper).adaptation;
    claim_readapts(paper, "spot-", degrees, frames, "", kPaper, claims);
    claim_readapts(find(cases, degrees, kLasting).adaptation, "spot-", degrees, frames, "-lasting", kOurs, claims);
    for (const LearningMode& mode : modes_to_measure(context, guiding_modes())) {
      const Adaptation& with = find(cases, degrees, {.mode = &mode}).adaptation;
      claim_readapts(with, "spot-", degrees, frames, fmt::format("-{}", mode.id), kOurs, claims);
      claim_gain(fmt::format("spot-{:.0f}", degrees), mode, paper.name, "after the turn and once adapted",
                 {{fmt::format("first {} frames", frames), error_ratio(early(paper, frames), early(with, frames))},
                  {"last 16 frames", error_ratio(paper.plateaus(16), with.plateaus(16))}},
                 claims);
    }
  }
}

void add_charts(const std::vector<Case>& cases, const char* title, ExperimentResult& result) {
  for (const float degrees : kTurns) {
    std::vector<Adaptation> list;
    for (const Case& c : cases) {
      if (c.degrees == degrees) list.push_back(c.adaptation);
    }
    result.blocks.emplace_back(adaptation_chart(
        fmt::format("{} by {:.0f}°", title, degrees),
        "Error of single frames after the change; bands are 95 % intervals of the mean over the runs.", list, 0));
  }
}

ExperimentResult run_cdq_adaptation(const ExperimentContext& context) {
  Adaptation bsdf;
  const std::vector<Case> cases = measure_wide(context, bsdf);
  const std::vector<Case> spot = measure_spot(context);
  ExperimentResult result;
  claim_speed(cases, 9, 10, result.claims);
  claim_speed(cases, 36, 20, result.claims);
  claim_bits(cases, bsdf, result.claims);
  claim_spot(context, spot, result.claims);
  add_charts(cases, "The lamp turns", result);
  add_charts(spot, "The narrow beam turns", result);
  result.setup = learning_setup(context);
  result.setup.emplace_back(
      "Runs",
      fmt::format("{} seeds; each has {} frames to adapt and {} after the change; with the narrow beam {} seeds "
                  "without modes",
                  context.choose(16, 2), context.choose(128, 8), context.choose(64, 28), context.choose(64, 2)));
  result.setup.emplace_back("Narrow beam", "errors over the pixels of the floor; modes are added to the paper's trees");
  return result;
}

}  // namespace

Experiment cdq_adaptation_experiment() {
  return {"cdq-adaptation", kPaper, "quadtrees of 32 to 128 bits after a sudden move of the light", run_cdq_adaptation};
}

}  // namespace relume
