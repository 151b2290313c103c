#include "viewer/model/start_settings.h"

#include <filesystem>

#include <gtest/gtest.h>

#include "files/atomic_file.h"
#include "relume/error.h"
#include "render/build_pipeline.h"
#include "render/presets.h"

namespace relume::viewer {
namespace {

LightSelectionChoice interactive_lights() { return resolve({.preset = "interactive"}).render.lights; }
DenoiseChoice interactive_denoiser() { return resolve({.preset = "interactive"}).render.denoise; }

TEST(StartSettings, DefaultToThePresetInteractive) {
  SettingSources sources;
  sources.flags = {{"width", "100"}, {"max-bounces", "3"}};
  const AllSettings settings = resolve_start(sources);
  EXPECT_EQ(settings.render.lights, interactive_lights());
  EXPECT_EQ(settings.render.denoise, interactive_denoiser());
  EXPECT_EQ(settings.render.width, 100);
  EXPECT_EQ(settings.render.path.max_bounces, 3);
}

TEST(StartSettings, KeepTheDefaultsIfTheUserChoosesATechnique) {
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

TEST(StartSettings, UseTheSizeFromFlagOrFile) {
  EXPECT_FALSE(chooses_size({}));
  EXPECT_FALSE(chooses_size({.preset = "preview"}));
  EXPECT_FALSE(chooses_size({.scene_json = R"({"width": 100})"}));  // saved views also follow the window
  EXPECT_TRUE(chooses_size({.flags = {{"height", "100"}}}));
  const auto file = std::filesystem::temp_directory_path() / "relume_start_settings_test.json";
  write_file(file, R"({"spp": 3})");
  EXPECT_FALSE(chooses_size({.file = file.string()}));
  write_file(file, R"({"spp": 3, "width": 100})");
  EXPECT_TRUE(chooses_size({.file = file.string()}));
  std::filesystem::remove(file);
}

TEST(Presets, AreIndependentOfEarlierChoices) {
  for (const Preset& before : presets()) {
    const AllSettings first = apply_preset(resolve_start({}), "", "", std::string(before.name));
    for (const Preset& preset : presets()) {
      AllSettings applied = apply_preset(first, "", "", std::string(preset.name));
      EXPECT_NO_THROW(check_combination(applied.render)) << preset.name << " after " << before.name;
      AllSettings fresh = resolve({.preset = std::string(preset.name)});
      fresh.render.path.max_bounces = applied.render.path.max_bounces;
      const SettingList a = describe(applied.render);
      const SettingList b = describe(fresh.render);
      for (size_t i = 0; i < a.size(); ++i)
        EXPECT_EQ(to_string(a[i]), to_string(b[i])) << a[i].name << " of " << preset.name << " after " << before.name;
    }
  }
}

TEST(Presets, KeepImageAndSceneSettings) {
  AllSettings current;
  current.render.width = 123;
  current.render.camera = "side";
  current.render.path.max_bounces = 5;
  current.scene.env = "none";
  current.output.exposure = 2;
  current.stop.spp = 7;
  const AllSettings settings = apply_preset(current, R"({"psf.cell-size": 3})", "scene", "paper-003");
  EXPECT_EQ(settings.render.width, 123);
  EXPECT_EQ(settings.render.camera, "side");
  EXPECT_EQ(settings.render.path.max_bounces, 5);
  EXPECT_EQ(settings.scene.env, "none");
  EXPECT_EQ(settings.output.exposure, 2);
  EXPECT_EQ(settings.stop.spp, 7);
  EXPECT_EQ(settings.render.psf.grid.cell_size, 3);
  EXPECT_EQ(settings.render.cache, CacheChoice::psf);
  EXPECT_EQ(apply_preset(current, "", "", "preview").render.path.max_bounces, 3);
}

TEST(SettingsInScene, StayExceptForThoseOfTheScene) {
  AllSettings current = resolve_start({});
  current.render.camera = "side";
  current.render.time_s = 2;
  current.render.shutter_s = 0.5f;
  current.scene.env = "none";
  current.render.width = 123;
  const AllSettings kept = settings_in_scene(current, "", "scene");
  EXPECT_EQ(kept.render.camera, "");
  EXPECT_EQ(kept.render.time_s, 0);
  EXPECT_EQ(kept.render.shutter_s, 0);
  EXPECT_EQ(kept.scene.env, "");
  EXPECT_EQ(kept.render.lights, interactive_lights());
  const AllSettings asked = settings_in_scene(current, R"({"max-bounces": 3})", "scene");
  EXPECT_EQ(asked.render.path.max_bounces, 3);
  EXPECT_EQ(asked.render.width, 123);
  EXPECT_EQ(asked.render.lights, interactive_lights());
}

TEST(SettingsInScene, AreTheScenesWhereTheyDoNotCombineWithTheUsers) {
  AllSettings current = resolve_start({.preset = "paper-000"});
  current.render.width = 123;
  const AllSettings settings = settings_in_scene(current, R"({"estimator": "bdpt"})", "scene");
  EXPECT_NO_THROW(check_combination(settings.render));
  EXPECT_EQ(settings.render.estimator, EstimatorChoice::bdpt);
  EXPECT_EQ(settings.render.cache, CacheChoice::none);
  EXPECT_EQ(settings.render.width, 123);
}

TEST(SettingsInScene, RejectUnknownAndIncompatibleSettingsOfTheScene) {
  EXPECT_THROW(settings_in_scene({}, R"({"max-bouncs": 3})", "scene"), Error);
  EXPECT_THROW(settings_in_scene({}, R"({"cache": "psf", "estimator": "light"})", "scene"), Error);
}

}  // namespace
}  // namespace relume::viewer
