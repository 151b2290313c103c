#include "experiments/setup/learning_scenes.h"

#include <gtest/gtest.h>

#include "render/settings.h"

namespace relume {
namespace {

TEST(LearningScenes, ThePapersCacheIsThatOfThePreset) {
  RenderSettings preset = resolve({.preset = "paper-002"}).render;
  RenderSettings helper;
  const SettingList a = describe(helper.vlc);
  const SettingList b = describe(preset.vlc);
  EXPECT_FALSE(differing_settings(a, b).empty());
  use_paper_cache(helper);
  for (const Setting* setting : differing_settings(a, b)) ADD_FAILURE() << setting->name;
}

}  // namespace
}  // namespace relume
