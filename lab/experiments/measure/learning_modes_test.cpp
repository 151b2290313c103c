#include "experiments/measure/learning_modes.h"

#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "settings/setting.h"

namespace relume {
namespace {

/// Names of the settings that a mode changes.
std::set<std::string> changed_by(const LearningMode& mode) {
  RenderSettings before;
  RenderSettings after;
  mode.apply(after);
  const SettingList a = describe(before);
  const SettingList b = describe(after);
  std::set<std::string> names;
  for (const Setting* setting : differing_settings(a, b)) names.emplace(setting->name);
  return names;
}

TEST(LearningModes, ChangeOneSettingEachAndAllInTheLast) {
  for (const std::span<const LearningMode> modes : {guiding_modes(), cache_modes()}) {
    std::set<std::string> all;
    std::set<std::string_view> ids;
    for (const LearningMode& mode : modes) {
      EXPECT_TRUE(ids.insert(mode.id).second) << mode.id;
      const std::set<std::string> changed = changed_by(mode);
      if (&mode == &modes.back()) {
        EXPECT_EQ(changed, all);
      } else {
        EXPECT_EQ(changed.size(), 1u) << mode.id;
      }
      all.insert(changed.begin(), changed.end());
    }
  }
}

TEST(LearningModes, AreAllMeasuredInFullRunsOnly) {
  ExperimentContext context;
  EXPECT_EQ(modes_to_measure(context, cache_modes()).size(), cache_modes().size());
  context.quick = true;
  ASSERT_EQ(modes_to_measure(context, cache_modes()).size(), 1u);
  EXPECT_EQ(modes_to_measure(context, cache_modes()).front().id, "all");
}

TEST(LearningModes, AreDecidedByIntervals) {
  const LearningMode& mode = guiding_modes().front();
  const auto gain = [](double low, double high) { return ModeGain{"scene", {(low + high) / 2, {low, high, 0.95}}}; };
  std::vector<Claim> claims;
  claim_gain("mode", mode, "cdq", "there", {gain(1.1, 1.3), gain(1.01, 1.2)}, claims);
  claim_gain("mode", mode, "cdq", "there", {gain(1.1, 1.3), gain(0.9, 1.2)}, claims);
  claim_harmless("mode", mode, "cdq", {gain(0.99, 1.01)}, claims);
  claim_harmless("mode", mode, "cdq", {gain(0.9, 0.95)}, claims);
  ASSERT_EQ(claims.size(), 4u);
  EXPECT_EQ(claims[0].verdict, kVerdictHolds);
  EXPECT_EQ(claims[1].verdict, kVerdictUndecided);
  EXPECT_EQ(claims[2].verdict, kVerdictHolds);
  EXPECT_EQ(claims[3].verdict, kVerdictFails);
  EXPECT_EQ(claims[0].id, "mode-useful");
  EXPECT_EQ(claims[2].id, "mode-useful-harmless");
}

}  // namespace
}  // namespace relume
