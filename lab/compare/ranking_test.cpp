#include "compare/ranking.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

double rel_mse_of(const Repetition& repetition) { return repetition.rel_mse; }

ContenderResult contender(const std::vector<double>& rel_mse, bool is_image = false) {
  ContenderResult result{.name = "name", .is_image = is_image, .settings = "{}"};
  for (const double value : rel_mse) result.repetitions.push_back({.rel_mse = value});
  return result;
}

std::vector<size_t> leaders_of(std::vector<ContenderResult> contenders, bool with_images = true) {
  Comparison c;
  c.contenders = std::move(contenders);
  return leaders(c, rel_mse_of, with_images);
}

using Indices = std::vector<size_t>;

TEST(Ranking, ADisjointIntervalLeads) {
  EXPECT_EQ(leaders_of({contender({4, 5, 6}), contender({1, 3, 2})}), Indices{1});
}

TEST(Ranking, OverlappingIntervalsShareTheLead) {
  EXPECT_EQ(leaders_of({contender({4, 5, 6}), contender({1, 2, 3}), contender({2.9, 3.5, 7})}), (Indices{1, 2}));
  EXPECT_EQ(leaders_of({contender({1, 1, 1}), contender({1, 1, 1})}), (Indices{0, 1}));
}

TEST(Ranking, TwoRepetitionsAreInconclusive) {
  EXPECT_EQ(leaders_of({contender({4, 5}), contender({1, 2})}), (Indices{1, 0}));
  EXPECT_EQ(leaders_of({contender({4}), contender({1})}), (Indices{1, 0}));
}

TEST(Ranking, AnImageHasNoInterval) {
  const ContenderResult image = contender({0.5}, true);
  EXPECT_EQ(leaders_of({contender({1, 2, 3}), image}), Indices{1});
  EXPECT_EQ(leaders_of({contender({1, 2, 3}), image}, false), Indices{0});
  EXPECT_EQ(leaders_of({contender({0.4, 2, 3}), image}), (Indices{1, 0}));
}

TEST(Ranking, NonFiniteValuesAreNotRanked) {
  ContenderResult broken = contender({0.1, 0.1, 0.1});
  broken.repetitions[1].nonfinite = 1;
  EXPECT_FALSE(is_ranked(broken));
  EXPECT_EQ(leaders_of({broken, contender({1, 2, 3})}), Indices{1});
  EXPECT_TRUE(leaders_of({broken}).empty());
}

}  // namespace
}  // namespace relume
