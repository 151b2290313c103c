#include "techniques/reuse/reservoir/reservoir.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "techniques/reuse/reservoir/combine_neighbours.h"
#include "techniques/reuse/reservoir/testing/reuse_toy.h"
#include "testing/chi2.h"
#include "testing/random.h"

namespace relume {
namespace {

using testing::Random;
using testing::ReuseToy;
using testing::ToyMode;
using testing::ToyNeighbours;
using testing::ToyOmission;

TEST(WeightedChoice, PicksInProportionToWeights) {
  const std::vector<float> weights{0.5f, 0, 3, 1e-3f, 1, 2.5f};
  double sum = 0;
  for (const float w : weights) sum += static_cast<double>(w);
  constexpr int kChoices = 200000;
  std::vector<uint64_t> counts(weights.size());
  Random random(1);
  for (int n = 0; n < kChoices; ++n) {
    WeightedChoice choice;
    size_t picked = 0;
    for (size_t i = 0; i < weights.size(); ++i) {
      if (choice.offer(weights[i], random.next())) picked = i;
    }
    ++counts[picked];
    ASSERT_FLOAT_EQ(choice.sum, static_cast<float>(sum));
  }
  std::vector<double> expected(weights.size());
  for (size_t i = 0; i < weights.size(); ++i) expected[i] = kChoices * static_cast<double>(weights[i]) / sum;
  EXPECT_EQ(counts[1], 0u);
  EXPECT_GT(testing::chi2_test(counts, expected).p_value, testing::significance());
}

TEST(WeightedChoice, TakesTheFirstSampleAndReportsInvalidOnes) {
  WeightedChoice choice;
  EXPECT_FALSE(choice.offer(0, 0));
  EXPECT_TRUE(choice.offer(1e-30f, kOneMinusEpsilon));
  EXPECT_FALSE(choice.offer(std::nanf(""), 0));
  EXPECT_FALSE(std::isfinite(choice.sum));
}

TEST(ChoiceNumbers, AreUniformAndDifferByPurpose) {
  std::vector<uint64_t> counts(64);
  constexpr uint32_t kPixels = 5000;
  for (uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    ChoiceNumbers numbers(3, 7, pixel, 1);
    for (int k = 0; k < 16; ++k) ++counts[static_cast<size_t>(64 * numbers.next())];
  }
  const std::vector<double> expected(counts.size(), 16.0 * kPixels / 64);
  EXPECT_GT(testing::chi2_test(counts, expected).p_value, testing::significance());
  EXPECT_NE(ChoiceNumbers(3, 7, 0, 1).next(), ChoiceNumbers(3, 7, 0, 2).next());
  EXPECT_NE(ChoiceNumbers(3, 7, 0, 1).next(), ChoiceNumbers(3, 8, 0, 1).next());
}

/// Shares with which each technique of a combination could have made one sample: weights of a result to which only that
/// technique contributes, with W = 1.
struct Domains {
  std::vector<float> targets;      ///< p̂ of the sample by domain; the first is canonical
  std::vector<float> confidences;  ///< by domain

  Reservoir<int> of(size_t i, float weight) const { return {0, weight, targets[i], confidences[i]}; }

  float pairwise_share(size_t technique) const {
    const auto weight = [&](size_t i) { return i == technique ? 1.0f : 0.0f; };
    PairwiseCombination<int> combination(of(0, weight(0)), static_cast<uint32_t>(targets.size() - 1));
    for (size_t i = 1; i < targets.size(); ++i) combination.add(of(i, weight(i)), targets[0], targets[i], 0.5f);
    return combination.finish(0.0f).weight;
  }
  float balanced_share(bool before) const {
    const auto now_target = [&](int) { return targets[0]; };
    const auto before_target = [&](int) { return targets[1]; };
    return combine_balanced(of(0, before ? 0.0f : 1.0f), of(1, before ? 1.0f : 0.0f), now_target, before_target, 0.0f)
        .weight;
  }
};

TEST(Shares, SumToOneForAnySample) {
  Random random(5);
  for (int n = 0; n < 2000; ++n) {
    Domains domains;
    const size_t count = 2 + static_cast<size_t>(7 * random.next());
    for (size_t i = 0; i < count; ++i) {
      const bool sees_it = i == 0 || random.next() < 0.7f;
      domains.targets.push_back(sees_it ? std::exp(8 * random.next() - 4) : 0.0f);
      domains.confidences.push_back(1 + 20 * random.next());
    }
    float sum = 0;
    for (size_t i = 0; i < count; ++i) {
      const float share = domains.pairwise_share(i);
      EXPECT_TRUE(domains.targets[i] > 0.0f || share == 0.0f) << "domain " << i << " cannot make the sample";
      sum += share;
    }
    ASSERT_NEAR(sum, 1, 1e-5f);
    ASSERT_NEAR(domains.balanced_share(false) + domains.balanced_share(true), 1, 1e-5f);
  }
}

struct Spread {
  double mean = 0;
  double error = 0;
};

Spread measure(const ToyMode& mode, int runs = 4000) {
  const ReuseToy toy;
  double sum = 0;
  double squares = 0;
  for (int run = 0; run < runs; ++run) {
    const double e = toy.run(mode, static_cast<uint32_t>(run));
    sum += e;
    squares += e * e;
  }
  const double mean = sum / runs;
  return {mean, std::sqrt((squares / runs - mean * mean) / (runs - 1))};
}

class KeepsTheMean : public ::testing::TestWithParam<ToyMode> {};
TEST_P(KeepsTheMean, InTheToy) {
  const Spread spread = measure(GetParam());
  EXPECT_LT(spread.error, 0.004);
  EXPECT_NEAR(spread.mean, 0, 4.5 * spread.error);
}
std::string toy_mode_name(const ::testing::TestParamInfo<ToyMode>& info) { return info.param.name; }
INSTANTIATE_TEST_SUITE_P(Modes, KeepsTheMean,
                         ::testing::Values(ToyMode{.name = "candidates", .neighbours = ToyNeighbours::none, .cap = 0},
                                           ToyMode{.name = "temporal", .neighbours = ToyNeighbours::none},
                                           ToyMode{.name = "pairwise"},
                                           ToyMode{.name = "pairwise_without_feedback", .feeds_back = false},
                                           ToyMode{.name = "refused_by_surfaces", .refused = 0.4f},
                                           ToyMode{.name = "spatial", .cap = 0},
                                           ToyMode{.name = "basic_with_occlusion", .neighbours = ToyNeighbours::basic},
                                           ToyMode{.name = "no_occlusion_anywhere", .occluded_targets = false}),
                         toy_mode_name);

/// A shortcut and the least energy that it loses.
struct Shortcut {
  ToyMode mode;
  double least_loss = 0;
};

class LosesLight : public ::testing::TestWithParam<Shortcut> {};
TEST_P(LosesLight, InTheToy) {
  const Spread spread = measure(GetParam().mode, 6000);
  EXPECT_LT(spread.mean + 4.5 * spread.error, -GetParam().least_loss);
}
std::string shortcut_name(const ::testing::TestParamInfo<Shortcut>& info) { return info.param.mode.name; }
INSTANTIATE_TEST_SUITE_P(
    Modes, LosesLight,
    ::testing::Values(
        Shortcut{{.name = "constant_weights", .neighbours = ToyNeighbours::constant}, 0.4},
        Shortcut{{.name = "hidden_discarded_temporal_and_pairwise", .occluded_targets = false, .discards_hidden = true},
                 0.1},
        Shortcut{{.name = "hidden_discarded_basic",
                  .neighbours = ToyNeighbours::basic,
                  .occluded_targets = false,
                  .discards_hidden = true},
                 0.1},
        Shortcut{{.name = "neighbours_without_sample_left_out", .omission = ToyOmission::without_sample}, 0},
        Shortcut{{.name = "naive_neighbours_left_out", .omission = ToyOmission::naive, .feeds_back = false, .cap = 0},
                 0.02},
        Shortcut{{.name = "naive_neighbours_left_out_basic",
                  .neighbours = ToyNeighbours::basic,
                  .omission = ToyOmission::naive,
                  .feeds_back = false,
                  .cap = 0},
                 0.02},
        Shortcut{{.name = "bright_samples_dropped", .boiling = 3.5f}, 0.1},
        Shortcut{{.name = "old_samples_dropped", .oldest = 4}, 0.002},
        Shortcut{{.name = "weights_clamped", .most_weight = 40}, 0.05}),
    shortcut_name);

/// A shift y = 1 − (1 − x)^(1/3) from a neighbour to a pixel, both with the constant integrand 1. Its Jacobian dy/dx
/// grows from 1/3 without bound.
struct CubicShift {
  float most = std::numeric_limits<float>::infinity();   ///< largest accepted Jacobian; its inverse is the smallest
  float clamp = std::numeric_limits<float>::infinity();  ///< upper bound of the Jacobian in weights

  static float inverse_jacobian(float y) { return 3 * (1 - y) * (1 - y); }
  bool moves(float inverse) const { return inverse * most >= 1 && inverse <= most; }
};

Spread measure(const CubicShift& shift) {
  constexpr int kRuns = 200000;
  double sum = 0;
  double squares = 0;
  Random random(3);
  for (int run = 0; run < kRuns; ++run) {
    const float own = random.next();
    const float moved = 1 - std::cbrt(1 - random.next());
    const float inverse = CubicShift::inverse_jacobian(moved);
    const float own_inverse = CubicShift::inverse_jacobian(own);
    PairwiseCombination<float> combination({own, 1, 1, 1}, 1);
    const Reservoir<float> neighbour{moved, std::min(1 / inverse, shift.clamp), inverse, 20};
    combination.add(neighbour, shift.moves(inverse) ? 1.0f : 0.0f, shift.moves(own_inverse) ? own_inverse : 0.0f,
                    random.next());
    const auto e = static_cast<double>(combination.finish(random.next()).weight) - 1;
    sum += e;
    squares += e * e;
  }
  const double mean = sum / kRuns;
  return {mean, std::sqrt((squares / kRuns - mean * mean) / (kRuns - 1))};
}

/// The two directions of a shift have reciprocal Jacobians, so a symmetric bound rejects both or neither.
TEST(Jacobians, MayBeRefusedButNotClamped) {
  for (const CubicShift& shift : {CubicShift{}, CubicShift{.most = 10}}) {
    const Spread right = measure(shift);
    EXPECT_LT(right.error, 0.004) << shift.most;
    EXPECT_NEAR(right.mean, 0, 4.5 * right.error) << shift.most;
  }
  const Spread clamped = measure(CubicShift{.clamp = 3});
  EXPECT_LT(clamped.mean + 4.5 * clamped.error, -0.02);
}

/// A pixel keeps its own history at rest: hidden candidates may then be discarded.
TEST(DiscardedCandidates, KeepTheMeanOfAPixelAtRest) {
  const Spread spread =
      measure({.neighbours = ToyNeighbours::none, .occluded_targets = false, .discards_hidden = true});
  EXPECT_NEAR(spread.mean, 0, 4.5 * spread.error);
}

/// One step of temporal reuse after the occlusion has changed from that of pixel `before` to that of pixel `now`. The
/// target of the earlier frame: that of its own scene, or of today's.
Spread measure_change(int now, int before, bool of_its_own_scene) {
  const ReuseToy toy;
  const ToyMode mode;
  double truth = 0;
  for (uint32_t k = 0; k < ReuseToy::kLights; ++k) truth += static_cast<double>(toy.shown(now, k));
  constexpr int kRuns = 100000;
  double sum = 0;
  double squares = 0;
  Random random(9);
  for (int run = 0; run < kRuns; ++run) {
    auto history = toy.candidates(mode, before, random);
    history.confidence = 8;
    const auto own = toy.candidates(mode, now, random);
    const auto now_target = [&](uint32_t k) { return toy.target(mode, now, k); };
    const auto before_target = [&](uint32_t k) { return toy.target(mode, of_its_own_scene ? before : now, k); };
    const auto result = combine_balanced(own, history, now_target, before_target, random.next());
    const double e = static_cast<double>(toy.shown(now, result.sample) * result.weight) / truth - 1;
    sum += e;
    squares += e * e;
  }
  const double mean = sum / kRuns;
  return {mean, std::sqrt((squares / kRuns - mean * mean) / (kRuns - 1))};
}

TEST(TemporalTargets, MustBeThoseOfTheEarlierFrame) {
  constexpr int kNow = 10;
  constexpr int kBefore = 11;  // other light points are hidden
  const Spread right = measure_change(kNow, kBefore, true);
  EXPECT_LT(right.error, 0.01);
  EXPECT_NEAR(right.mean, 0, 4.5 * right.error);
  const Spread wrong = measure_change(kNow, kBefore, false);
  EXPECT_LT(wrong.mean, -0.05);
}

/// Reservoirs without a sample have no target to ask for, but their confidence counts.
TEST(CombineNeighbours, AsksForTargetsOfSamplesOnly) {
  const std::vector<Reservoir<uint32_t>> reservoirs = {
      {.sample = 1, .weight = 2, .target = 0.5f, .confidence = 3},
      {.sample = 0, .weight = 0, .target = 0, .confidence = 4},
      {.sample = 2, .weight = 1, .target = 2, .confidence = 5},
  };
  ReuseNeighbours near;
  for (const uint32_t pixel : {1u, 2u}) near.pixels[near.count++] = pixel;
  std::vector<uint32_t> asked_here;
  std::vector<uint32_t> asked_there;
  const auto here = [&](uint32_t i, const Reservoir<uint32_t>& neighbour) {
    asked_here.push_back(i);
    return 0.25f * static_cast<float>(neighbour.sample);
  };
  const auto there = [&](uint32_t i) {
    asked_there.push_back(i);
    return 0.75f;
  };
  for (uint32_t seed = 0; seed < 16; ++seed) {
    ChoiceNumbers numbers(seed, 0, 0, 0);
    const Reservoir<uint32_t> result =
        combine_neighbours_pairwise(reservoirs[0], view_of(reservoirs), near, here, there, numbers);
    ChoiceNumbers again(seed, 0, 0, 0);
    PairwiseCombination<uint32_t> expected(reservoirs[0], 2);
    expected.add(reservoirs[1], 0, 0.75f, again.next());
    expected.add(reservoirs[2], 0.5f, 0.75f, again.next());
    const Reservoir<uint32_t> direct = expected.finish(again.next());
    EXPECT_EQ(result.sample, direct.sample);
    EXPECT_EQ(result.weight, direct.weight);
    EXPECT_EQ(result.confidence, 12);
    EXPECT_EQ(asked_here, std::vector<uint32_t>{1});
    EXPECT_EQ(asked_there, (std::vector<uint32_t>{0, 1}));
    asked_here.clear();
    asked_there.clear();
  }
}

}  // namespace
}  // namespace relume
