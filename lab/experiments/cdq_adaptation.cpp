// [Dittebrandt20 §7.3]: measures how fast quadtrees adapt to a sudden change in light direction.
#include <algorithm>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/adaptation.h"
#include "experiments/measure/learning_regions.h"
#include "experiments/setup/learning_scenes.h"
#include "experiments/setup/references.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Dittebrandt20 §7.3]";
constexpr float kDegreesPerSecond = 36;  // speed of the turntable

/// A quadtree variant: lasting, or the paper's with this number of bits and migrations.
struct Variation {
  int bits = 128;
  int migrations = 1;
  bool lasting = false;

  bool operator==(const Variation&) const = default;
  std::string name() const {
    return lasting ? "lasting quadtrees"
                   : fmt::format("{} bits, {} migration{}", bits, migrations, migrations == 1 ? "" : "s");
  }
};
constexpr Variation kAsInThePaper = {};
constexpr Variation kLasting = {.lasting = true};

struct Case {
  float degrees;
  Variation variation;
  Adaptation adaptation;  ///< frame 0 is the first one after the change
};

/// Reference after the change, and the pixels with surfaces for errors.
struct Goal {
  Reference reference;
  PixelMask surfaces;
};

/// Adapts to the lamp's first position, moves it, and measures the following frames.
Case measure(const ExperimentContext& context, Session& session, const RenderSettings& base, const Goal& goal,
             float degrees, const Variation& variation) {
  RenderSettings settings = base;
  settings.guide = GuideChoice::cdq;
  if (variation.lasting) {
    use_lasting_quadtrees(settings);
  } else {
    settings.cdq.bits = static_cast<QuadtreeBits>(variation.bits / 32 - 1);
    settings.cdq.migrations = variation.migrations;
  }
  session.set_settings(settings);
  Case result{degrees, variation, {}};
  const int warm_up = context.choose(128, 8);
  const auto prepare = [&](Session& s, int frame) {
    if (frame > 0) return;
    s.set_time(0);
    for (int i = 0; i < warm_up; ++i) {
      context.check_stop();
      s.render_frame();
    }
    s.set_time(degrees / kDegreesPerSecond);
  };
  const std::string stage = fmt::format("{:.0f}°, {}", degrees, variation.name());
  result.adaptation = measure_adaptation(context, stage, session, context.choose(16, 2), context.choose(64, 28),
                                         goal.reference, goal.surfaces, prepare);
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

void claim_readapts(const Adaptation& adaptation, float degrees, size_t frames, const char* suffix, const char* source,
                    std::vector<Claim>& claims) {
  claims.push_back(judged_adapted(
      fmt::format("readapts-{:.0f}{}", degrees, suffix), source,
      fmt::format("After {:.0f}° the trees ({}) readapt in about {} frames.", degrees, adaptation.name, frames),
      adaptation, frames));
}

void claim_speed(const std::vector<Case>& cases, float degrees, size_t frames, std::vector<Claim>& claims) {
  const Adaptation& one = find(cases, degrees, kAsInThePaper).adaptation;
  claim_readapts(one, degrees, frames, "", kPaper, claims);
  claim_readapts(find(cases, degrees, kLasting).adaptation, degrees, frames, "-lasting", "[relume]", claims);
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

ExperimentResult run_cdq_adaptation(const ExperimentContext& context) {
  const ExperimentScene scene = learning_scene("turntable");
  RenderSettings settings = scene.settings;
  set_size_and_device(context, settings);
  settings.history = HistoryChoice::none;
  Session session(Scene(scene.scene), settings);
  session.set_camera(scene.camera);
  std::vector<Case> cases;
  Adaptation bsdf;
  for (const float degrees : {9.0f, 36.0f}) {
    const Goal goal = goal_after(context, scene, degrees);
    if (degrees > 20) {
      RenderSettings plain = settings;
      plain.time_s = degrees / kDegreesPerSecond;
      session.set_settings(plain);
      bsdf = measure_adaptation(context, "BSDF", session, context.choose(16, 2), 4, goal.reference, goal.surfaces);
    }
    for (const int bits : {32, 64, 96, 128}) {
      if (degrees > 20 || bits % 64 == 0)
        cases.push_back(measure(context, session, settings, goal, degrees, {bits, 1}));
    }
    cases.push_back(measure(context, session, settings, goal, degrees, kLasting));
    for (const int migrations : {2, 4, 8}) {
      if (degrees > 20 || migrations == 8)
        cases.push_back(measure(context, session, settings, goal, degrees, {128, migrations}));
    }
  }
  ExperimentResult result;
  claim_speed(cases, 9, 10, result.claims);
  claim_speed(cases, 36, 20, result.claims);
  claim_bits(cases, bsdf, result.claims);
  for (const float degrees : {9.0f, 36.0f}) {
    std::vector<Adaptation> list;
    for (const Case& c : cases) {
      if (c.degrees == degrees) list.push_back(c.adaptation);
    }
    result.blocks.emplace_back(adaptation_chart(
        fmt::format("The lamp turns by {:.0f}°", degrees),
        "Error of single frames after the change; bands are 95 % intervals of the mean over the runs.", list, 0));
  }
  result.setup = learning_setup(context);
  result.setup.emplace_back("Runs", fmt::format("{} seeds; each has {} frames to adapt and {} after the change",
                                                context.choose(16, 2), context.choose(128, 8), context.choose(64, 28)));
  return result;
}

}  // namespace

Experiment cdq_adaptation_experiment() {
  return {"cdq-adaptation", kPaper, "quadtrees of 32 to 128 bits after a sudden move of the light", run_cdq_adaptation};
}

}  // namespace relume
