// Reservoirs: one sample each, chosen from many by resampled importance sampling, and weights with which reservoirs of
// several domains combine without bias ([Bitterli20], [Lin22]). A domain is a pixel in one frame, with its integrand.
// Independent of the type of samples.
#pragma once

#include "core/hash.h"
#include "core/hd.h"

namespace relume {

/// A chosen sample. The pixel's integrand at the sample, times `weight`, estimates the pixel's integral.
template <typename Sample>
struct Reservoir {
  Sample sample{};
  float weight = 0;      ///< W: unbiased contribution weight of [Lin22], an estimate of 1 / density; 0: no sample
  float target = 0;      ///< p̂ of the sample in the domain that owns the reservoir
  float confidence = 0;  ///< c: number of frames whose candidates contributed; 0: no reservoir
};

/// Independent uniform numbers that decide choices of a pixel in a frame. Choices must not use the stratified sequences
/// of paths: these depend on the numbers of earlier frames, which made the reservoirs among which they choose.
struct ChoiceNumbers {
  uint32_t state = 0;

  RELUME_HD ChoiceNumbers(uint32_t seed, uint32_t frame, uint32_t pixel, uint32_t purpose)
      : state(hash(seed, frame, pixel, purpose)) {}

  /// In [0, 1).
  RELUME_HD float next() { return to_unit_float(next_bits()); }
  RELUME_HD uint32_t next_bits() { return state = hash(state, 0x51ed270bu); }
};

/// Chooses one of a stream of samples with probability proportional to its weight ([Bitterli20] alg. 2).
struct WeightedChoice {
  float sum = 0;  ///< of the weights so far; not finite if a weight was not

  /// Whether the sample of this weight replaces the one chosen so far. `u`: uniform in [0, 1). The first sample of
  /// positive weight is always chosen.
  RELUME_HD bool offer(float weight, float u) {
    if (weight <= 0.0f) return false;
    sum += weight;
    return u * sum < weight;
  }
};

/// Share of a technique in the balance heuristic, from its and the other's confidence times target.
RELUME_HD inline float balance_share(float own, float other) { return own > 0.0f ? own / (own + other) : 0.0f; }

/// Combines the reservoirs of two domains by the generalised balance heuristic of [Lin22]. `now_target(y)`: p̂ of a
/// sample in the domain of `now`, which receives the result. `before_target(y)`: p̂ in that of `before`. Both are
/// called at most once. `u`: uniform in [0, 1), independent of both reservoirs.
template <typename Sample, typename NowTarget, typename BeforeTarget>
RELUME_HD inline Reservoir<Sample> combine_balanced(const Reservoir<Sample>& now, const Reservoir<Sample>& before,
                                                    const NowTarget& now_target, const BeforeTarget& before_target,
                                                    float u) {
  Reservoir<Sample> result = now;
  result.confidence = now.confidence + before.confidence;
  WeightedChoice choice;
  if (now.weight > 0.0f) {
    const float other = before.confidence > 0.0f ? before.confidence * before_target(now.sample) : 0.0f;
    choice.offer(balance_share(now.confidence * now.target, other) * now.target * now.weight, 0.0f);
  }
  if (before.weight > 0.0f && before.confidence > 0.0f) {
    const float target = now_target(before.sample);
    const float share = balance_share(before.confidence * before.target, now.confidence * target);
    if (choice.offer(share * target * before.weight, u)) {
      result.sample = before.sample;
      result.target = target;
    }
  }
  result.weight = choice.sum > 0.0f ? choice.sum / result.target : 0.0f;
  return result;
}

/// Combines a pixel's own reservoir, the canonical one, with those of k neighbours by pairwise MIS in the form of the
/// published code of [Lin22]: neighbour i has the share rᵢ / (k + 1), the canonical reservoir the rest. The shares of
/// each sample sum to one. Neighbours must be chosen by their surfaces alone: a choice by their samples adds bias.
template <typename Sample>
class PairwiseCombination {
 public:
  /// `count`: number of neighbours that add() will receive.
  RELUME_HD PairwiseCombination(const Reservoir<Sample>& canonical, uint32_t count)
      : canonical_(canonical), result_(canonical), count_(static_cast<float>(static_cast<int>(count))) {
    result_.target = 0;
  }

  /// Adds a neighbour. `target_here`: p̂ of the neighbour's sample at this pixel. `canonical_there`: p̂ of the
  /// canonical sample at the neighbour. `u`: uniform in [0, 1).
  RELUME_HD void add(const Reservoir<Sample>& neighbour, float target_here, float canonical_there, float u) {
    const float part = canonical_.confidence / count_;
    result_.confidence += neighbour.confidence;
    left_to_canonical_ += 1.0f - balance_share(neighbour.confidence * canonical_there, part * canonical_.target);
    if (!(neighbour.weight > 0.0f)) return;
    const float share = balance_share(neighbour.confidence * neighbour.target, part * target_here) / (count_ + 1.0f);
    if (!choice_.offer(share * target_here * neighbour.weight, u)) return;
    result_.sample = neighbour.sample;
    result_.target = target_here;
  }

  /// The combined reservoir, after all neighbours were added.
  RELUME_HD Reservoir<Sample> finish(float u) {
    const float share = (1.0f + left_to_canonical_) / (count_ + 1.0f);
    if (choice_.offer(share * canonical_.target * canonical_.weight, u)) {
      result_.sample = canonical_.sample;
      result_.target = canonical_.target;
    }
    result_.weight = choice_.sum > 0.0f ? choice_.sum / result_.target : 0.0f;
    return result_;
  }

 private:
  Reservoir<Sample> canonical_;
  Reservoir<Sample> result_;
  WeightedChoice choice_;
  float left_to_canonical_ = 0;  ///< Σ (1 − rᵢ) at the canonical sample
  float count_;
};

/// Combines reservoirs by the weights cᵢ p̂ Wᵢ, and normalises by the domains that could have sampled the chosen one
/// ([Bitterli20] alg. 6, the form that RTXDI calls "basic"). Unbiased only if the targets are zero wherever the
/// integrand is: see README.md.
template <typename Sample>
class BasicCombination {
 public:
  /// Adds reservoir number `index`. `target_here`: p̂ of its sample in the domain that receives the result.
  RELUME_HD void add(const Reservoir<Sample>& source, uint32_t index, float target_here, float u) {
    result_.confidence += source.confidence;
    if (!(source.weight > 0.0f) || !choice_.offer(source.confidence * target_here * source.weight, u)) return;
    result_.sample = source.sample;
    result_.target = target_here;
    chosen_ = index;
  }

  RELUME_HD const Sample& sample() const { return result_.sample; }
  /// p̂ of the chosen sample in the domain that receives the result.
  RELUME_HD float target() const { return result_.target; }
  RELUME_HD uint32_t chosen() const { return chosen_; }

  /// The combined reservoir. `of_source`: p̂ of the chosen sample in its source's domain. `of_all`: Σ cⱼ p̂ⱼ of it over
  /// all domains.
  RELUME_HD Reservoir<Sample> finish(float of_source, float of_all) {
    const bool valid = choice_.sum > 0.0f && result_.target > 0.0f && of_all > 0.0f;
    result_.weight = valid ? choice_.sum * (of_source / of_all) / result_.target : 0.0f;
    return result_;
  }

 private:
  Reservoir<Sample> result_;
  WeightedChoice choice_;
  uint32_t chosen_ = 0;
};

/// Combines the reservoirs of two domains by BasicCombination; arguments as for combine_balanced().
template <typename Sample, typename NowTarget, typename BeforeTarget>
RELUME_HD inline Reservoir<Sample> combine_basic(const Reservoir<Sample>& now, const Reservoir<Sample>& before,
                                                 const NowTarget& now_target, const BeforeTarget& before_target,
                                                 float u) {
  BasicCombination<Sample> combination;
  combination.add(now, 0, now.target, 0.0f);
  combination.add(before, 1, before.weight > 0.0f ? now_target(before.sample) : 0.0f, u);
  if (!combination.sample().valid()) return combination.finish(0.0f, 0.0f);
  const bool from_before = combination.chosen() == 1;
  const float here = from_before ? now_target(combination.sample()) : now.target;
  const float there = from_before ? before.target : before_target(combination.sample());
  return combination.finish(from_before ? there : here, now.confidence * here + before.confidence * there);
}

}  // namespace relume
