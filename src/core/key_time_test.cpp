#include "core/key_time.h"

#include <gtest/gtest.h>

namespace relume {
namespace {

TEST(KeyTime, EveryTimeLiesBetweenTwoKeys) {
  for (const uint32_t keys : {2u, 3u, 9u, 65u}) {
    for (int i = 0; i <= 1000; ++i) {
      const float time = static_cast<float>(i) / 1000;
      const KeyTime at(time, keys);
      ASSERT_LE(at.first + 2, keys);
      ASSERT_GE(at.share, 0.0f);
      ASSERT_LE(at.share, 1.0f);
      EXPECT_NEAR(static_cast<float>(at.first) + at.share, time * static_cast<float>(keys - 1), 1e-4f);
    }
  }
}

TEST(KeyTime, KeysAreExact) {
  constexpr uint32_t kKeys = 9;
  float values[kKeys];
  for (uint32_t k = 0; k < kKeys; ++k) values[k] = 0.1f + 0.7f * static_cast<float>(k * k);
  for (uint32_t k = 0; k < kKeys; ++k) {
    const KeyTime at(static_cast<float>(k) / (kKeys - 1), kKeys);
    EXPECT_EQ(at.mix(values[at.first], values[at.first + 1]), values[k]) << k;
  }
  const KeyTime middle(kShutterMiddle, kKeys);
  EXPECT_EQ(middle.first, kKeys / 2);
  EXPECT_EQ(middle.share, 0.0f);
}

}  // namespace
}  // namespace relume
