// [Schipek22 §6.1], figures 6.5 to 6.14: measures the bias of the average frame.
#include <string_view>

#include <fmt/format.h>

#include "experiments/all.h"
#include "experiments/measure/ratio.h"
#include "experiments/measure/scene_averages.h"
#include "experiments/setup/cache_scenes.h"
#include "experiments/setup/named.h"

namespace relume {
namespace {

constexpr const char* kPaper = "[Schipek22 §6.1]";
constexpr const char* kOurs = "[relume]";

/// apg with the largest constant whose variance is at most half of path tracing's; nullptr if none. Both variances
/// exclude lamp edges, where caches trace additional camera rays. The choice ignores the biases, since their noise
/// would favour the lowest of several.
const FrameAverages* quiet_graph(const SceneAverages& scene) {
  const double limit = 0.5 * named(scene.caches, "cache", "path").surface_variance.value;
  const FrameAverages* best = nullptr;
  for (const FrameAverages& a : scene.graphs) {
    if (a.surface_variance.value <= limit) best = &a;
  }
  return best;
}

/// Claims that a's bias² is below `factor` times b's.
void claim_less_bias(std::string id, std::string claim, const FrameAverages& a, const FrameAverages& b, double factor,
                     const std::string& note, std::vector<Claim>& claims, const char* source = kPaper) {
  claims.push_back({std::move(id), source, std::move(claim),
                    fmt::format("{}: bias² {} against {} of {}, difference {}{}", a.name, with_noise(a.bias2),
                                with_noise(b.bias2), b.name, with_noise(difference(a.bias2, b.bias2)), note),
                    factor == 1 ? kBeyondNoise : fmt::format("below {} times {}'s beyond the noise", factor, b.name),
                    verdict_below(difference(a.bias2, scaled(b.bias2, factor)))});
}

void claim_graph(const SceneAverages& scene, std::vector<Claim>& claims) {
  const FrameAverages& path = named(scene.caches, "cache", "path");
  const FrameAverages* graph = quiet_graph(scene);
  const std::string id = "graph-bias-" + scene.name;
  const std::string claim =
      fmt::format("{}: apg has less bias than psf where its variance is at most half of path tracing's.", scene.name);
  if (!graph) {
    std::string measured = "no constant has so little variance:";
    for (const FrameAverages& a : scene.graphs)
      measured += fmt::format(" {:.2f} of path tracing's with {}",
                              a.surface_variance.value / path.surface_variance.value, a.name);
    claims.push_back(unmeasured(id, kPaper, claim, kBeyondNoise, measured));
    return;
  }
  claim_less_bias(id, claim, *graph, named(scene.caches, "cache", "psf"), 1,
                  fmt::format("; variance away from lamps {:.2f} of path tracing's",
                              graph->surface_variance.value / path.surface_variance.value),
                  claims);
}

/// With the same cells, both have almost the same bias, so that "no more" requires a margin.
void claim_primary(const SceneAverages& scene, std::vector<Claim>& claims) {
  claim_less_bias("primary-bias-" + scene.name, fmt::format("{}: apsf has no more bias than psf.", scene.name),
                  named(scene.caches, "cache", "apsf"), named(scene.caches, "cache", "psf"), 1.05, "", claims);
}

constexpr const char* kOnePercent = "within 1 %";

std::string light_text(const std::string& scene) { return scene + ": apsf shows as much light as psf."; }

std::string interpolation_text(const std::string& scene) {
  return scene + ": apsf that blends cells with paths (one-over-square) has less bias than psf.";
}

void claim_interpolation(const SceneAverages& scene, std::vector<Claim>& claims) {
  claim_less_bias("interpolation-bias-" + scene.name, interpolation_text(scene.name),
                  named(scene.caches, "cache", "apsf, one-over-square"), named(scene.caches, "cache", "psf"), 1, "",
                  claims);
}

/// Where light is rare, culling paths by their cells could lose some of it.
void claim_light(const SceneAverages& scene, std::vector<Claim>& claims) {
  const Ratio ratio =
      paired_error_ratio(named(scene.caches, "cache", "apsf").light, named(scene.caches, "cache", "psf").light);
  claims.push_back(judged_within("primary-light-" + scene.name, kOurs, light_text(scene.name),
                                 share_text(ratio) + " of psf's", kOnePercent, {ratio}, 0.99, 1.01));
}

std::string option_bias_id(const CacheOption& option, const std::string& scene) {
  return fmt::format("option-bias-{}-{}", option.name, scene);
}
std::string option_light_id(const CacheOption& option, const std::string& scene) {
  return fmt::format("option-light-{}-{}", option.name, scene);
}

/// Whether a claim compares the brightness of an option with that of psf. Path graphs have biases of their own.
bool compares_light(const CacheOption& option) { return option.basis != std::string_view("apg"); }

std::string option_bias_text(const CacheOption& option, const std::string& scene) {
  return fmt::format("{}: {} has {} bias than {}.", scene, option.name, option.reduces_bias ? "less" : "no more",
                     option.basis);
}
std::string option_light_text(const CacheOption& option, const std::string& scene) {
  return fmt::format("{}: {} shows as much light as psf.", scene, option.name);
}

void claim_options(const SceneAverages& scene, std::vector<Claim>& claims) {
  if (scene.options.empty()) return;
  const FrameAverages& psf = named(scene.caches, "cache", "psf");
  for (const CacheOption& option : kCacheOptions) {
    const FrameAverages& a = named(scene.options, "option", option.name);
    const FrameAverages& basis = named(scene.caches, "cache", option.basis);
    claim_less_bias(option_bias_id(option, scene.name), option_bias_text(option, scene.name), a, basis,
                    option.reduces_bias ? 1 : 1.05,
                    fmt::format("; variance {} against {}", with_noise(a.variance), with_noise(basis.variance)), claims,
                    kOurs);
    if (!compares_light(option)) continue;
    const Ratio light = paired_error_ratio(a.light, psf.light);
    claims.push_back(judged_within(option_light_id(option, scene.name), kOurs, option_light_text(option, scene.name),
                                   share_text(light) + " of psf's", kOnePercent, {light}, 0.99, 1.01));
  }
}

/// The same claims about Sponza, if it is missing.
std::vector<SponzaClaim> option_claims_about_sponza() {
  std::vector<SponzaClaim> list;
  for (const CacheOption& option : kCacheOptions) {
    list.push_back({option_bias_id(option, "Sponza"), option_bias_text(option, "Sponza"), kBeyondNoise});
    if (compares_light(option))
      list.push_back({option_light_id(option, "Sponza"), option_light_text(option, "Sponza"), kOnePercent});
  }
  return list;
}

ExperimentResult run_psf_bias(const ExperimentContext& context) {
  std::vector<SceneAverages> scenes;
  for (const ExperimentScene& scene : cache_scenes(context))
    scenes.push_back(measure_averages(context, scene, CacheSet::techniques));
  ExperimentResult result;
  for (const SceneAverages& scene : scenes) {
    claim_graph(scene, result.claims);
    claim_primary(scene, result.claims);
    claim_interpolation(scene, result.claims);
    claim_light(scene, result.claims);
    claim_options(scene, result.claims);
  }
  claim_without_sponza(
      context, kPaper,
      {{"graph-bias-Sponza", "Sponza: apg has less bias than psf where its variance is at most half of path tracing's.",
        kBeyondNoise},
       {"primary-bias-Sponza", "Sponza: apsf has no more bias than psf.", kBeyondNoise},
       {"interpolation-bias-Sponza", interpolation_text("Sponza"), kBeyondNoise}},
      result.claims);
  claim_without_sponza(context, kOurs, {{"primary-light-Sponza", light_text("Sponza"), kOnePercent}}, result.claims);
  claim_without_sponza(context, kOurs, option_claims_about_sponza(), result.claims);
  show_averages(context, scenes, result);
  return result;
}

}  // namespace

Experiment psf_bias_experiment() { return {"psf-bias", kPaper, "bias of radiance caches", run_psf_bias}; }

}  // namespace relume
