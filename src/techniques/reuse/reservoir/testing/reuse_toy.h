// A small model of a frame, for tests of reservoirs: a ring of 32 pixels, lit by 24 light points. Each pixel has its
// own occlusion. A reused sample keeps its light point. The model shows the sign of a bias, not its size in real
// scenes.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "techniques/reuse/reservoir/reservoir.h"
#include "testing/random.h"

namespace relume::testing {

/// How a mode combines reservoirs of neighbours.
enum class ToyNeighbours { none, pairwise, basic, constant };

/// Neighbours that a mode leaves out because of their own samples.
enum class ToyOmission {
  none,
  without_sample,  ///< those of weight 0, which still count in the weights of the others
  naive,           ///< those with a sample but no history, which do not count; biased
};

struct ToyMode {
  const char* name = "";
  ToyNeighbours neighbours = ToyNeighbours::pairwise;
  ToyOmission omission = ToyOmission::none;
  bool occluded_targets = true;  ///< whether targets contain occlusion
  bool discards_hidden = false;  ///< whether occluded candidates get weight 0, even if targets ignore occlusion
  bool feeds_back = true;        ///< whether neighbours' samples enter the history
  float cap = 8;                 ///< limit of the history's confidence, frames; 0: no temporal reuse
  float refused = 0;             ///< probability that a neighbour is rejected for its surface
  float boiling = 0;             ///< weight, relative to the mean, above which samples are dropped; 0: no limit
  int oldest = 0;                ///< age, frames, above which histories are dropped; 0: no limit
  float most_weight = 0;         ///< limit to which weights are clamped; 0: no limit
};

class ReuseToy {
 public:
  static constexpr int kPixels = 32;
  static constexpr uint32_t kLights = 24;

  /// A sample is the number of its light point, plus kLights times the number of its candidate (frame * kPixels +
  /// pixel).
  using ToyReservoir = Reservoir<uint32_t>;

  ReuseToy() {
    double sum = 0;
    for (uint32_t k = 0; k < kLights; ++k) sum += density_[k] = 1 + 0.5 * std::sin(static_cast<double>(k));
    double below = 0;
    for (uint32_t k = 0; k < kLights; ++k) {
      density_[k] /= sum;
      below_[k] = below += density_[k];
    }
    for (int i = 0; i < kPixels; ++i) {
      for (uint32_t k = 0; k < kLights; ++k) {
        const int light = static_cast<int>(k);
        const double d = std::fmod(0.75 * i - light + 36.0, 24.0) - 12.0;
        unoccluded_[i][k] = static_cast<float>(std::exp(-d * d / 8) + 0.05);
        const bool visible = (i * 7 + light * 3) / 9 % 3 != 0 && !(i > 20 && light < 8);
        shown_[i][k] = visible ? unoccluded_[i][k] : 0.0f;
        truth_ += static_cast<double>(shown_[i][k]);
      }
    }
  }

  /// Renders 16 frames. Returns the relative error of the mean over all pixels of the last eight.
  double run(const ToyMode& mode, uint32_t seed) const {
    constexpr int kFrames = 16;
    Random random(seed);
    std::vector<ToyReservoir> history(kPixels);
    std::vector<ToyReservoir> current(kPixels);
    double sum = 0;
    for (int frame = 0; frame < kFrames; ++frame) {
      for (int i = 0; i < kPixels; ++i) {
        current[i] = candidates(mode, i, random);
        current[i].sample += kLights * static_cast<uint32_t>(frame * kPixels + i);
        if (frame > 0 && mode.cap > 0) current[i] = with_history(mode, i, frame, current[i], history[i], random);
      }
      std::vector<ToyReservoir> result = current;
      for (int i = 0; i < kPixels && mode.neighbours != ToyNeighbours::none; ++i)
        result[i] = with_neighbours(mode, i, current, random);
      limit_weights(mode, result);
      for (int i = 0; i < kPixels && frame >= kFrames / 2; ++i)
        sum += static_cast<double>(shown(i, result[i].sample) * result[i].weight);
      history = mode.feeds_back ? result : current;
    }
    return sum / (kFrames / 2) / truth_ - 1;
  }

  float target(const ToyMode& mode, int pixel, uint32_t sample) const {
    return mode.occluded_targets ? shown(pixel, sample) : unoccluded_[pixel][sample % kLights];
  }
  float shown(int pixel, uint32_t sample) const { return shown_[pixel][sample % kLights]; }
  double density(uint32_t light) const { return density_[light]; }

  uint32_t draw(Random& random) const {
    const auto u = static_cast<double>(random.next());
    uint32_t k = 0;
    while (k + 1 < kLights && u >= below_[k]) ++k;
    return k;
  }

  /// Resamples two candidates.
  ToyReservoir candidates(const ToyMode& mode, int pixel, Random& random) const {
    constexpr int kCandidates = 2;
    ToyReservoir chosen;
    WeightedChoice choice;
    for (int c = 0; c < kCandidates; ++c) {
      const uint32_t light = draw(random);
      const float weight = target(mode, pixel, light) / static_cast<float>(kCandidates * density_[light]);
      if (choice.offer(weight, random.next())) chosen.sample = light;
    }
    chosen.confidence = 1;
    chosen.target = target(mode, pixel, chosen.sample);
    chosen.weight = choice.sum > 0.0f ? choice.sum / chosen.target : 0.0f;
    if (mode.discards_hidden && shown_[pixel][chosen.sample] == 0.0f) chosen.weight = 0;
    return chosen;
  }

 private:
  ToyReservoir with_history(const ToyMode& mode, int pixel, int frame, const ToyReservoir& now, ToyReservoir before,
                            Random& random) const {
    before.confidence = std::fmin(before.confidence, mode.cap);
    const int age = frame - static_cast<int>(before.sample / (kLights * kPixels));
    if (mode.oldest > 0 && before.weight > 0.0f && age > mode.oldest) before.confidence = 0;
    const auto at = [&](uint32_t light) { return target(mode, pixel, light); };
    return combine_balanced(now, before, at, at, random.next());
  }

  struct Near {
    std::array<int, 2> pixels;
    uint32_t count = 0;
  };

  Near choose_neighbours(const ToyMode& mode, int pixel, const std::vector<ToyReservoir>& current,
                         Random& random) const {
    Near near;
    for (int n = 0; n < 2; ++n) {
      const int distance = 1 + static_cast<int>(5 * random.next());
      const bool left = random.next() < 0.5f;
      const int other = (pixel + (left ? -distance : distance) + kPixels) % kPixels;
      if (random.next() < mode.refused) continue;
      if (mode.omission == ToyOmission::naive && current[other].weight > 0.0f && current[other].confidence <= 1.0f)
        continue;
      near.pixels[near.count++] = other;
    }
    return near;
  }

  ToyReservoir with_neighbours(const ToyMode& mode, int pixel, const std::vector<ToyReservoir>& current,
                               Random& random) const {
    const ToyReservoir& own = current[pixel];
    const Near near = choose_neighbours(mode, pixel, current, random);
    if (mode.neighbours == ToyNeighbours::pairwise) {
      PairwiseCombination<uint32_t> combination(own, near.count);
      for (uint32_t n = 0; n < near.count; ++n) {
        const ToyReservoir& neighbour = current[near.pixels[n]];
        if (mode.omission == ToyOmission::without_sample && neighbour.weight == 0.0f) continue;
        combination.add(neighbour, target(mode, pixel, neighbour.sample), target(mode, near.pixels[n], own.sample),
                        random.next());
      }
      return combination.finish(random.next());
    }
    BasicCombination<uint32_t> combination;
    combination.add(own, 0, own.target, 0.0f);
    for (uint32_t n = 0; n < near.count; ++n) {
      const ToyReservoir& neighbour = current[near.pixels[n]];
      combination.add(neighbour, n + 1, target(mode, pixel, neighbour.sample), random.next());
    }
    const uint32_t light = combination.sample();
    float of_source = target(mode, pixel, light);
    float of_all = own.confidence * of_source;
    float confidence = own.confidence;
    for (uint32_t n = 0; n < near.count; ++n) {
      const float there = target(mode, near.pixels[n], light);
      of_all += current[near.pixels[n]].confidence * there;
      confidence += current[near.pixels[n]].confidence;
      if (combination.chosen() == n + 1) of_source = there;
    }
    if (mode.neighbours == ToyNeighbours::constant) return combination.finish(1.0f, confidence);
    return combination.finish(of_source, of_all);
  }

  /// Drops or clamps large weights.
  static void limit_weights(const ToyMode& mode, std::vector<ToyReservoir>& reservoirs) {
    float sum = 0;
    int count = 0;
    for (const ToyReservoir& r : reservoirs) {
      sum += r.weight;
      count += r.weight > 0.0f ? 1 : 0;
    }
    for (ToyReservoir& r : reservoirs) {
      if (mode.boiling > 0.0f && r.weight * static_cast<float>(count) > mode.boiling * sum) r.weight = 0;
      if (mode.most_weight > 0.0f) r.weight = std::fmin(r.weight, mode.most_weight);
    }
  }

  std::array<double, kLights> density_;
  std::array<double, kLights> below_;
  float unoccluded_[kPixels][kLights];
  float shown_[kPixels][kLights];
  double truth_ = 0;
};

}  // namespace relume::testing
