#include "viewer/model/setting_rules.h"

#include <gtest/gtest.h>

namespace relume::viewer {
namespace {

TEST(SettingRules, OnlyOtherChoicesOfASlotMakeASettingIdle) {
  AllSettings settings;
  EXPECT_EQ(takes_effect_with(settings, "max-bounces"), "");
  EXPECT_EQ(takes_effect_with(settings, "path.russian-roulette"), "");
  settings.render.history = HistoryChoice::none;
  EXPECT_EQ(takes_effect_with(settings, "reproject.stored"), "history = reproject");
  EXPECT_EQ(takes_effect_with(settings, "unknown.anything"), "");
  EXPECT_EQ(takes_effect_with(settings, "psf.cell-size"), "cache = psf");
  EXPECT_EQ(takes_effect_with(settings, "psf.edge-rays"), "cache = psf");
  EXPECT_EQ(takes_effect_with(settings, "features.edge-rays"), "denoise = bmfr");
  settings.render.denoise = DenoiseChoice::svgf;
  EXPECT_EQ(takes_effect_with(settings, "features.edge-rays"), "");
  settings.render.cache = CacheChoice::apsf_apg;
  for (const char* name : {"psf.cell-size", "apsf.blend", "apg.feed"})
    EXPECT_EQ(takes_effect_with(settings, name), "") << name;
  EXPECT_EQ(takes_effect_with(settings, "psf.edge-rays"), "denoise = none");
  settings.render.denoise = DenoiseChoice::none;
  EXPECT_EQ(takes_effect_with(settings, "psf.edge-rays"), "");
  settings.render.cache = CacheChoice::apg;
  EXPECT_EQ(takes_effect_with(settings, "psf.cell-size"), "");
  EXPECT_EQ(takes_effect_with(settings, "apsf.blend"), "cache = apsf");
  EXPECT_EQ(takes_effect_with(settings, "sharc.cell-size"), "cache = sharc");
  settings.render.cache = CacheChoice::sharc;
  EXPECT_EQ(takes_effect_with(settings, "sharc.cell-size"), "");
  EXPECT_EQ(takes_effect_with(settings, "psf.cell-size"), "cache = psf");
  EXPECT_EQ(takes_effect_with(settings, "octree.split"), "lights = vlc or guide = cdq");
  settings.render.guide = GuideChoice::cdq;
  EXPECT_EQ(takes_effect_with(settings, "octree.split"), "");
}

TEST(SettingRules, IncompatibleChoicesGiveAReason) {
  AllSettings settings;
  EXPECT_EQ(refusal(settings, "cache", "psf"), "");
  settings.render.lights = LightSelectionChoice::vlc;
  settings.render.guide = GuideChoice::cdq;
  for (const char* cache : {"psf", "apsf", "apg", "apsf+apg"})
    EXPECT_EQ(refusal(settings, "cache", cache), "") << cache;
  settings.render = {};
  settings.render.reuse = ReuseChoice::restir_pt;
  EXPECT_NE(refusal(settings, "estimator", "bdpt").find("'restir-pt' does not combine"), std::string::npos);
  settings.render = {};
  settings.render.history = HistoryChoice::none;
  EXPECT_NE(refusal(settings, "allocation", "adaptive").find("history 'none'"), std::string::npos);
  settings.render = {};
  settings.render.cache = CacheChoice::psf;
  EXPECT_EQ(refusal(settings, "estimator", "bdpt"), "");
  EXPECT_NE(refusal(settings, "estimator", "light").find("radiance cache"), std::string::npos);
}

}  // namespace
}  // namespace relume::viewer
