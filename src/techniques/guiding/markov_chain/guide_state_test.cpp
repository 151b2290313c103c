#include "techniques/guiding/markov_chain/guide_state.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "techniques/guiding/markov_chain/testing/random_states.h"

namespace relume {
namespace {

constexpr GuidePrior kPrior{0.2f, 0.1f};

TEST(GuideState, TheLobeFollowsTheParallaxOfItsTarget) {
  const Vec3 target(1, 2, -0.5f);
  GuideState s;
  for (int i = 0; i < 100; ++i) add_target(s, {}, Vec3(0), target, 3, 0);
  EXPECT_EQ(s.count, 100);
  EXPECT_NEAR(s.weight, 3, 1e-5f);
  for (const Vec3& p : {Vec3(0), Vec3(1, 0, 0), Vec3(-3, 2, 4)}) {
    VonMisesFisher lobe;
    ASSERT_TRUE(lobe_at(s, p, kPrior, lobe));
    EXPECT_NEAR(glm::dot(lobe.axis, glm::normalize(target - p)), 1.0f, 1e-5f);
    EXPECT_EQ(lobe.concentration, VonMisesFisher::kMostConcentration);
  }
}

TEST(GuideState, SpreadTargetsGiveAWideLobe) {
  testing::Random random(3);
  GuideState wide;
  GuideState narrow;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 offset = random.point(1);
    add_target(wide, {}, Vec3(0), Vec3(0, 0, 2) + offset, 1, 0);
    add_target(narrow, {}, Vec3(0), Vec3(0, 0, 2) + 0.1f * offset, 1, 0);
  }
  VonMisesFisher lobes[2];
  ASSERT_TRUE(lobe_at(wide, Vec3(0), kPrior, lobes[0]));
  ASSERT_TRUE(lobe_at(narrow, Vec3(0), kPrior, lobes[1]));
  EXPECT_GT(lobes[0].concentration, 2.0f);
  EXPECT_LT(lobes[0].concentration, 60.0f);
  EXPECT_GT(lobes[1].concentration, 10 * lobes[0].concentration);
  EXPECT_GT(lobes[0].axis.z, 0.95f);
}

TEST(GuideState, TheMeanScoreForgetsAtTheLeastRate) {
  GuideState s;
  const ChainRates rates{0.1f, 1024};
  for (int i = 0; i < 1000; ++i) add_target(s, rates, Vec3(0), Vec3(0, 0, 1), 1, 0);
  for (int i = 0; i < 10; ++i) add_target(s, rates, Vec3(0), Vec3(0, 0, 1), 3, 7);
  EXPECT_NEAR(s.weight, 3 - 2 * std::pow(0.9f, 10.0f), 1e-4f);
  EXPECT_EQ(s.frame, 7u);
  const ChainRates counts{1e-4f, 8};
  GuideState few;
  for (int i = 0; i < 100; ++i) add_target(few, counts, Vec3(0), Vec3(0, 0, 1), 1, 0);
  EXPECT_EQ(few.count, 8);
}

TEST(GuideState, ThePriorWidensLobesOfFewTargetsNearBy) {
  GuideState one;
  add_target(one, {}, Vec3(0), Vec3(0, 0, 1), 1, 0);
  GuideState near_by;
  add_target(near_by, {}, Vec3(0), Vec3(0, 0, 0.05f), 1, 0);
  VonMisesFisher lobes[2];
  ASSERT_TRUE(lobe_at(one, Vec3(0), kPrior, lobes[0]));
  ASSERT_TRUE(lobe_at(near_by, Vec3(0), kPrior, lobes[1]));
  EXPECT_LT(lobes[1].concentration, 0.1f * lobes[0].concentration);
  // 1 / (1 + 0.2 · (0.1 / 1)²).
  EXPECT_NEAR(mean_cosine(one, kPrior, 1), 1 / 1.002f, 1e-5f);
}

TEST(GuideState, TargetsKeepTheirMotion) {
  GuideState s;
  add_target(s, {}, Vec3(0), Vec3(0, 0, 2), 5, 10);
  set_motion(s, Vec3(0.25f, -0.5f, 0));
  EXPECT_EQ(mean_target(moved_to_frame(s, 10)), mean_target(s));
  const Vec3 later = mean_target(moved_to_frame(s, 14));
  EXPECT_NEAR(later.x, 1, 1e-5f);
  EXPECT_NEAR(later.y, -2, 1e-5f);
  EXPECT_NEAR(later.z, 2, 1e-5f);
  EXPECT_EQ(mean_target(moved_to_frame(s, 1000)), mean_target(moved_to_frame(s, 26)));
}

TEST(GuideState, MotionIsRoundedToEightBits) {
  for (const float x : {0.0f, 1.0f, -0.3f, 1e-6f, 123.4f})
    EXPECT_NEAR(unpack_motion(pack_motion(x)), x, std::fabs(x) / 250) << x;
  EXPECT_EQ(unpack_motion(pack_motion(kInfinity)), 0.0f);
  EXPECT_EQ(unpack_motion(pack_motion(std::nanf(""))), 0.0f);
}

TEST(GuideState, GarbageGivesNoLobeOrAFiniteOne) {
  int lobes = 0;
  for (uint32_t i = 0; i < 20000; ++i) {
    VonMisesFisher lobe;
    if (!lobe_at(moved_to_frame(testing::garbage_state(i), i), Vec3(1, 2, 3), kPrior, lobe)) continue;
    ASSERT_TRUE(is_finite(lobe.axis)) << i;
    ASSERT_NEAR(glm::length(lobe.axis), 1.0f, 1e-3f) << i;
    ASSERT_TRUE(lobe.concentration >= 0.0f && lobe.concentration <= VonMisesFisher::kMostConcentration) << i;
    ++lobes;
  }
  EXPECT_GT(lobes, 20);
}

TEST(GuideState, ATargetReplacesGarbage) {
  for (uint32_t i = 0; i < 1000; ++i) {
    GuideState s = testing::garbage_state(i);
    if (is_usable(s)) continue;
    add_target(s, {}, Vec3(0), Vec3(0, 0, 2), 5, 1);
    ASSERT_EQ(s.count, 1) << i;
    ASSERT_NEAR(s.weight, 5, 1e-5f) << i;
    ASSERT_NEAR(mean_target(s).z, 2, 1e-5f) << i;
  }
}

TEST(GuideState, LightVanishesOnlyWhereTheLobePoints) {
  const GuideState s = testing::narrow_state(Vec3(0, 0, 2));
  const Vec3 up(0, 0, 1);
  EXPECT_TRUE(has_vanished(s, kPrior, Vec3(0), up, 0));
  EXPECT_FALSE(has_vanished(s, kPrior, Vec3(0), up, 0.1f));  // there is light
  EXPECT_FALSE(has_vanished(s, kPrior, Vec3(0), glm::normalize(Vec3(1, 0, 1)), 0));
  GuideState wide = s;
  wide.cosine = 0.2f;
  EXPECT_TRUE(has_vanished(wide, kPrior, Vec3(0), glm::normalize(Vec3(0.3f, 0, 1)), 0));
  EXPECT_FALSE(has_vanished(s, kPrior, Vec3(0), glm::normalize(Vec3(0.3f, 0, 1)), 0));
}

}  // namespace
}  // namespace relume
