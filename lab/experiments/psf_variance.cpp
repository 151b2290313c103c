// [Schipek22 §6.1], figures 6.5 to 6.14: measures the deviation of frames from their average.
#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/scene_averages.h"
#include "experiments/setup/cache_scenes.h"
#include "experiments/setup/named.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Schipek22 §6.1]";

void claim_least_variance(const SceneAverages& scene, std::vector<Claim>& claims) {
  const FrameAverages& psf = named(scene.caches, "cache", "psf");
  const FrameAverages* least = &named(scene.caches, "cache", "path");
  std::vector<const char*> verdicts;
  const auto compare = [&](const FrameAverages& other) {
    if (other.name == psf.name) return;
    if (other.variance.value < least->variance.value) least = &other;
    verdicts.push_back(verdict_below(difference(psf.variance, other.variance)));
  };
  for (const FrameAverages& a : scene.caches) compare(a);
  for (const FrameAverages& a : scene.graphs) compare(a);
  claims.push_back(
      {"least-variance-" + scene.name, kPaper, fmt::format("{}: psf has the least variance.", scene.name),
       fmt::format("psf {}, least of the others: {} with {}, difference {}", with_noise(psf.variance), least->name,
                   with_noise(least->variance), with_noise(difference(psf.variance, least->variance))),
       kBeyondNoise, verdict_of_all(verdicts)});
}

/// Verdict that a figure falls (or rises) at every step from one constant to the next.
const char* verdict_on_steps(const std::vector<FrameAverages>& graphs, Estimate FrameAverages::*figure, bool falls) {
  std::vector<const char*> verdicts;
  for (size_t i = 1; i < graphs.size(); ++i) {
    const Estimate& before = graphs[i - 1].*figure;
    const Estimate& after = graphs[i].*figure;
    verdicts.push_back(verdict_below(falls ? difference(after, before) : difference(before, after)));
  }
  return verdict_of_all(verdicts);
}

void claim_monotone(const SceneAverages& scene, std::vector<Claim>& claims) {
  const auto add = [&](const char* id, const char* text, Estimate FrameAverages::*figure, bool falls) {
    std::string measured;
    for (const FrameAverages& a : scene.graphs) {
      measured += fmt::format("{}{}: {}", measured.empty() ? "" : ", ", a.name.substr(a.name.rfind(' ') + 1),
                              with_noise(a.*figure));
    }
    claims.push_back({id + scene.name, kPaper,
                      fmt::format("{}: the larger the variance constant of apg, the {}.", scene.name, text),
                      "by constant: " + measured,
                      "every step from one constant to the next is in this direction by more than its noise (95 %); "
                      "fails if a step is in the other direction by more than its noise",
                      verdict_on_steps(scene.graphs, figure, falls)});
  };
  add("monotone-bias-", "less bias", &FrameAverages::bias2, true);
  add("monotone-variance-", "more variance", &FrameAverages::variance, false);
}

ExperimentResult run_psf_variance(const ExperimentContext& context) {
  std::vector<SceneAverages> scenes;
  for (const ExperimentScene& scene : cache_scenes(context))
    scenes.push_back(measure_averages(context, scene, CacheSet::constants));
  ExperimentResult result;
  for (const SceneAverages& scene : scenes) {
    claim_least_variance(scene, result.claims);
    claim_monotone(scene, result.claims);
  }
  claim_without_sponza(
      context, kPaper,
      {{"least-variance-Sponza", "Sponza: psf has the least variance.", kBeyondNoise},
       {"monotone-bias-Sponza", "Sponza: the larger the variance constant of apg, the less bias.", kBeyondNoise},
       {"monotone-variance-Sponza", "Sponza: the larger the variance constant of apg, the more variance.",
        kBeyondNoise}},
      result.claims);
  show_averages(context, scenes, result);
  return result;
}

}  // namespace

Experiment psf_variance_experiment() {
  return {"psf-variance", kPaper, "variance of radiance caches, and the variance constant of path graphs",
          run_psf_variance};
}

}  // namespace relume
