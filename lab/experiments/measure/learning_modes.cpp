#include "experiments/measure/learning_modes.h"

#include <utility>

#include <fmt/format.h>

namespace relume {
namespace {

constexpr const char* kOurs = "[relume]";

/// Number of samples from which a region learns from its own only: the octree's threshold for joining regions.
constexpr int kPool = 2048;

void count_useful(RenderSettings& s) { s.octree.count = OctreeCount::useful; }
void learn_fraction(RenderSettings& s) { s.cdq.learn_fraction = true; }
void pool_samples(RenderSettings& s) { s.cdq.pool = kPool; }
void resample(RenderSettings& s) { s.cdq.candidates = 4; }
void list_infinite(RenderSettings& s) { s.vlc.infinite = CachedInfinity::entries; }
void learn_exploration(RenderSettings& s) { s.vlc.learn_exploration = true; }
void measure_change(RenderSettings& s) { s.vlc.change_measure = ChangeMeasure::amount; }

void use_all_of_guiding(RenderSettings& s) {
  count_useful(s);
  learn_fraction(s);
  pool_samples(s);
  resample(s);
}

void use_all_of_cache(RenderSettings& s) {
  count_useful(s);
  list_infinite(s);
  learn_exploration(s);
  measure_change(s);
}

constexpr LearningMode kGuidingModes[] = {{"useful", "regions of useful samples", count_useful},
                                          {"fraction", "learned fractions", learn_fraction},
                                          {"pool", "pooled samples", pool_samples},
                                          {"candidates", "4 candidates", resample},
                                          {"all", "all modes", use_all_of_guiding}};

constexpr LearningMode kCacheModes[] = {{"useful", "regions of useful samples", count_useful},
                                        {"infinite", "suns and sky listed", list_infinite},
                                        {"exploration", "learned exploration", learn_exploration},
                                        {"change", "changes by amount", measure_change},
                                        {"all", "all modes", use_all_of_cache}};

std::vector<Ratio> ratios_of(const std::vector<ModeGain>& gains) {
  std::vector<Ratio> ratios;
  for (const ModeGain& gain : gains) ratios.push_back(gain.ratio);
  return ratios;
}

std::string text_of(const std::vector<ModeGain>& gains) {
  std::string text;
  for (const ModeGain& gain : gains)
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", gain.scene, to_text(gain.ratio));
  return text;
}

}  // namespace

std::span<const LearningMode> guiding_modes() { return kGuidingModes; }

std::span<const LearningMode> cache_modes() { return kCacheModes; }

std::span<const LearningMode> modes_to_measure(const ExperimentContext& context, std::span<const LearningMode> modes) {
  return context.quick ? modes.last(1) : modes;
}

std::string with_mode(std::string_view base, const LearningMode& mode) {
  return fmt::format("{}, {}", base, mode.name);
}

void claim_gain(std::string_view id, const LearningMode& mode, std::string_view base, std::string_view where,
                const std::vector<ModeGain>& gains, std::vector<Claim>& claims) {
  claims.push_back(judged_ratios(fmt::format("{}-{}", id, mode.id), kOurs,
                                 fmt::format("{}, with {}: less error {}.", base, mode.name, where), text_of(gains),
                                 ratios_of(gains), 1));
}

void claim_harmless(std::string_view id, const LearningMode& mode, std::string_view base,
                    const std::vector<ModeGain>& gains, std::vector<Claim>& claims) {
  claims.push_back(
      judged_ratios(fmt::format("{}-{}-harmless", id, mode.id), kOurs,
                    fmt::format("{}, with {}: at most 1.02 times the error anywhere else.", base, mode.name),
                    text_of(gains), ratios_of(gains), 1 / 1.02));
}

}  // namespace relume
