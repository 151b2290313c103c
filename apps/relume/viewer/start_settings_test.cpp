#include "viewer/start_settings.h"

#include <gtest/gtest.h>

namespace relume::viewer {
namespace {

CacheChoice interactive_cache() { return resolve({.preset = "interactive"}).render.cache; }
DenoiseChoice interactive_denoiser() { return resolve({.preset = "interactive"}).render.denoise; }

TEST(StartSettings, AreInteractiveWhereNobodySaysOtherwise) {
  SettingSources sources;
  sources.flags = {{"width", "100"}, {"max-bounces", "3"}};
  const Settings settings = resolve_start(sources);
  EXPECT_EQ(settings.render.cache, interactive_cache());
  EXPECT_EQ(settings.render.denoise, interactive_denoiser());
  EXPECT_EQ(settings.render.width, 100);
  EXPECT_EQ(settings.render.path.max_bounces, 3);
}

TEST(StartSettings, AreTheUsersWhereTheySpeakOfTechniques) {
  const RenderSettings plain;
  for (const auto& flag : {std::pair("denoise", "none"), std::pair("lights", "vlc"), std::pair("cache", "none")}) {
    SettingSources sources;
    sources.flags = {{flag.first, flag.second}};
    EXPECT_EQ(resolve_start(sources).render.denoise, plain.denoise) << flag.first;
    EXPECT_EQ(resolve_start(sources).render.cache, plain.cache) << flag.first;
  }
  EXPECT_EQ(resolve_start({.preset = "preview"}).render.denoise, plain.denoise);
  SettingSources scene;
  scene.scene_json = R"({"guide": "cdq"})";
  EXPECT_EQ(resolve_start(scene).render.denoise, plain.denoise);
  EXPECT_EQ(resolve_start(scene).render.guide, GuideChoice::cdq);
}

}  // namespace
}  // namespace relume::viewer
