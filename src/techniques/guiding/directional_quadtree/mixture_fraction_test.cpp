#include "techniques/guiding/directional_quadtree/mixture_fraction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

namespace relume {
namespace {

/// Samples of one region.
class Fractions : public ::testing::Test {
 protected:
  /// Adds samples whose density is that of a mixture with fraction `sampled`.
  void add(float bsdf, float tree, float value, int times, float sampled = 0.5f) {
    const float mixture = sampled * bsdf + (1 - sampled) * tree;
    for (int i = 0; i < times; ++i) {
      records_.push_back({.region = 0,
                          .value = value,
                          .densities = pack_densities(mixture, tree),
                          .bsdf = pack_densities(1.0f, bsdf)});
    }
  }

  float learn() {
    std::vector<uint32_t> order(records_.size());
    std::iota(order.begin(), order.end(), 0u);
    const std::vector<uint32_t> counts{static_cast<uint32_t>(records_.size())};
    const std::vector<uint32_t> offsets{0, counts[0]};
    const LearnFractionsKernel kernel{{view_of(records_), view_of(order), view_of(offsets), view_of(counts)},
                                      mutable_view_of(moments_)};
    for (uint32_t k = 0; k < MixtureMoments::kFractions; ++k) kernel(0, k);
    records_.clear();
    return best_fraction(moments_[0], prior_);
  }

  std::vector<VertexSample> records_;
  std::vector<MixtureMoments> moments_ = std::vector<MixtureMoments>(1);
  FractionPrior prior_;
};

TEST_F(Fractions, FollowTheDistributionThatFindsTheLight) {
  add(0.001f, 4, 1, 4000);
  EXPECT_FLOAT_EQ(learn(), 0.1f);
  moments_[0] = {};
  add(4, 0.001f, 1, 4000);
  EXPECT_FLOAT_EQ(learn(), 0.9f);
}

TEST_F(Fractions, MinimiseTheSecondMoment) {
  // Two disjoint parts of the sphere, one for each distribution. With second moments a and b at equal fractions, the
  // best fraction is √a / (√a + √b). The same samples drawn with another fraction lead to it, too.
  for (const float sampled : {0.5f, 0.3f}) {
    moments_[0] = {};
    // Contributions are radiance over density, and numbers of samples follow the fraction.
    add(1, 0, 2 / sampled, static_cast<int>(200000 * sampled), sampled);
    add(0, 1, 1 / (1 - sampled), static_cast<int>(200000 * (1 - sampled)), sampled);
    EXPECT_NEAR(learn(), 2.0f / 3, 0.02f) << sampled;
    EXPECT_EQ(moments_[0].samples, 4096.0f);  // spread over both parts
  }
}

TEST_F(Fractions, StartFromThePrior) {
  for (const float start : {0.3f, 0.5f, 0.8f}) {
    prior_ = {.fraction = start};
    moments_[0] = {};
    EXPECT_EQ(learn(), start);
    add(0.001f, 4, 1, 4);  // few samples
    EXPECT_NEAR(learn(), start, 0.1f);
    add(0.001f, 4, 1, 4000);
    EXPECT_LT(learn(), 0.25f);
  }
  prior_ = {.fraction = 1};
  moments_[0] = {};
  EXPECT_EQ(learn(), 1.0f);
}

TEST_F(Fractions, IgnoreSamplesWithoutLightAndWithoutAFiniteMoment) {
  add(0.001f, 4, 1, 4000);
  const float expected = learn();
  moments_[0] = {};
  add(0.001f, 4, 1, 4000);
  add(1, 1, 0, 500);
  add(1, 1, kInfinity, 3);
  EXPECT_EQ(learn(), expected);
}

TEST_F(Fractions, ForgetEarlierFrames) {
  add(0.001f, 4, 1, 4000);
  learn();
  for (int frame = 0; frame < 200; ++frame) {
    add(4, 0.001f, 1, 400);
    learn();
  }
  add(4, 0.001f, 1, 400);
  EXPECT_GT(learn(), 0.8f);
}

TEST_F(Fractions, CountRecordsByTheirWeight) {
  add(1, 0, 2, 1000);
  add(0, 1, 1, 3000);
  const float expected = learn();
  moments_[0] = {};
  add(1, 0, 2, 250);
  for (VertexSample& s : records_) s.weight = 4;
  add(0, 1, 1, 3000);
  EXPECT_NEAR(learn(), expected, 1e-3f);
}

TEST_F(Fractions, AreInherited) {
  add(0.001f, 4, 1, 4000);
  const float learned = learn();
  const std::vector<uint32_t> previous{0, kNoRegion, 0};
  std::vector<MixtureMoments> next(3);
  std::vector<float> fractions(3);
  const InheritFractionsKernel kernel{view_of(previous), view_of(moments_), prior_, mutable_view_of(next),
                                      mutable_view_of(fractions)};
  for (uint32_t region = 0; region < 3; ++region) kernel(region, 0);
  EXPECT_EQ(fractions, (std::vector<float>{learned, 0.5f, learned}));
  EXPECT_EQ(next[2].samples, moments_[0].samples);
}

}  // namespace
}  // namespace relume
