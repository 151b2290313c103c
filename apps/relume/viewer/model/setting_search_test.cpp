#include "viewer/model/setting_search.h"

#include <gtest/gtest.h>

#include <optional>

#include "render/settings.h"

namespace relume::viewer {
namespace {

/// Number of settings that a query finds.
size_t found(std::string_view query) {
  AllSettings settings;
  size_t count = 0;
  for (const Setting& setting : describe(settings)) count += matches(setting, query) ? 1 : 0;
  return count;
}

bool finds(const char* name, std::string_view query) {
  AllSettings settings;
  return matches(require_setting(describe(settings), name, ""), query);
}

TEST(SettingSearch, EssentialSettingsExist) {
  AllSettings settings;
  for (const std::string_view name : kEssentialSettings)
    EXPECT_NE(find_setting(describe(settings), name), nullptr) << name;
}

TEST(SettingSearch, FindsByNameHelpAndChoice) {
  EXPECT_TRUE(finds("psf.cell-size", "cell-size"));
  EXPECT_TRUE(finds("psf.cell-size", "blur")) << "of its help";
  EXPECT_TRUE(finds("denoise", "svgf")) << "one of its choices";
  EXPECT_FALSE(finds("psf.cell-size", "exposure"));
}

TEST(SettingSearch, TakesEveryWordInAnyOrderAndCase) {
  EXPECT_TRUE(finds("psf.cell-size", "Blur EDGE psf"));
  EXPECT_FALSE(finds("psf.cell-size", "blur octree"));
  EXPECT_TRUE(finds("psf.cell-size", "  edge  "));
}

TEST(SettingSearch, NarrowsWithEveryLetter) {
  EXPECT_EQ(found(""), found("   "));
  EXPECT_GT(found(""), 60u);
  EXPECT_GT(found("oct"), 3u);
  EXPECT_LT(found("oct"), found("o"));
  EXPECT_EQ(found("no setting mentions this"), 0u);
}

TEST(SettingSearch, AFixedExposureBeginsWhereTheAutomaticOneIs) {
  std::optional<float> exposure;
  const OptionalNumberRef number{&exposure, "auto"};
  set_automatic(number, false, 2.5f);
  EXPECT_EQ(exposure, 2.5f);
  set_automatic(number, false, 1.0f);
  EXPECT_EQ(exposure, 2.5f) << "it was fixed already";
  set_automatic(number, true, 1.0f);
  EXPECT_FALSE(exposure);
}

}  // namespace
}  // namespace relume::viewer
