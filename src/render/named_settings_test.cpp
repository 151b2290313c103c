#include "relume/settings.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "relume/error.h"
#include "render/settings.h"

namespace relume {
namespace {

TEST(NamedSettings, MatchTheCommandLine) {
  AllSettings defaults;
  const SettingList declared = describe(defaults);
  const std::vector<SettingInfo> list = Settings::list();
  ASSERT_EQ(list.size(), declared.size());
  const Settings settings;
  for (size_t i = 0; i < list.size(); ++i) {
    EXPECT_EQ(list[i].name, declared[i].name);
    EXPECT_EQ(settings.get(list[i].name), list[i].default_value);
  }
}

TEST(NamedSettings, AreSetAndRead) {
  Settings settings;
  settings.set("width", 320).set("cache", "psf").set("psf.cell-size", 2.5).set("stratify", false);
  EXPECT_EQ(settings.get("width"), "320");
  EXPECT_EQ(settings.get("psf.cell-size"), "2.5");
  EXPECT_EQ(all_settings(settings).render.cache, CacheChoice::psf);
  EXPECT_FALSE(all_settings(settings).render.stratify);
  EXPECT_EQ(Settings().apply_json(settings.to_json(), "test").to_json(), settings.to_json());
}

TEST(NamedSettings, RejectInvalidValuesWithoutChange) {
  Settings settings;
  EXPECT_THROW(settings.set("image-width", 1), Error);
  EXPECT_THROW(settings.set("width", "wide"), Error);
  EXPECT_THROW(settings.set("cache", "all"), Error);
  EXPECT_THROW(settings.get("image-width"), Error);
  EXPECT_THROW(settings.apply_preset("none"), Error);
  EXPECT_THROW(settings.apply_json("{", "test"), Error);
  EXPECT_EQ(settings.to_json(), Settings().to_json());
}

TEST(NamedSettings, CopiesAreIndependent) {
  Settings settings;
  Settings copy = settings;
  copy.set("width", 7);
  EXPECT_NE(settings.get("width"), "7");
  settings = copy;
  EXPECT_EQ(settings.get("width"), "7");
}

TEST(NamedSettings, PresetsApply) {
  const std::vector<std::string> presets = Settings::presets();
  EXPECT_NE(std::find(presets.begin(), presets.end(), "interactive"), presets.end());
  for (const std::string& preset : presets) EXPECT_NO_THROW(Settings().apply_preset(preset)) << preset;
}

}  // namespace
}  // namespace relume
