#include "render/settings.h"

#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <set>

#include "relume/error.h"
#include "render/presets.h"
#include "scene/scene.h"
#include "settings/settings_json.h"

namespace relume {
namespace {

std::string message_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

/// A settings file that is deleted on destruction.
class SettingsFile {
 public:
  explicit SettingsFile(const std::string& text)
      : path_(std::filesystem::path(testing::TempDir()) / "relume_settings_test.json") {
    std::ofstream(path_) << text;
  }
  ~SettingsFile() { std::filesystem::remove(path_); }
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

TEST(Settings, NamesAreKebabCaseAndUnique) {
  AllSettings settings;
  std::set<std::string> names;
  for (const Setting& setting : describe(settings)) {
    EXPECT_TRUE(names.insert(setting.name).second) << setting.name;
    for (const char c : setting.name)
      EXPECT_TRUE(std::islower(c) || std::isdigit(c) || c == '-' || c == '.') << setting.name;
    EXPECT_FALSE(setting.help.empty()) << setting.name;
  }
}

TEST(Settings, HaveTheNamesThatScriptsRelyOn) {
  AllSettings settings;
  const SettingList list = describe(settings);
  for (const char* name : {"width",      "height",  "spp",       "max-bounces", "seed",  "threads", "exposure",
                           "camera",     "env",     "estimator", "lights",      "guide", "reuse",   "cache",
                           "allocation", "history", "denoise",   "time",        "error", "tone-map"}) {
    EXPECT_NE(find_setting(list, name), nullptr) << name;
  }
}

TEST(Settings, DefaultsFitTheirOwnRanges) {
  AllSettings settings;
  for (const Setting& setting : describe(settings))
    EXPECT_NO_THROW(parse_value(setting, to_string(setting), "default"));
}

TEST(Settings, SurviveJson) {
  AllSettings written;
  for (const Setting& setting : describe(written)) {  // changes every value from its default
    if (auto* const* flag = std::get_if<bool*>(&setting.value)) **flag = !**flag;
    if (auto* const* number = std::get_if<int*>(&setting.value)) **number += **number < setting.traits.max ? 1 : -1;
    if (auto* const* number = std::get_if<float*>(&setting.value))
      **number += **number + 0.1f <= setting.traits.max ? 0.1f : -0.1f;
    if (const auto* number = std::get_if<OptionalNumberRef>(&setting.value)) *number->value = 0.5f;
    if (auto* const* text = std::get_if<std::string*>(&setting.value)) **text = "1,2,3";
    if (const auto* slot = std::get_if<ChoiceRef>(&setting.value))
      *slot->value = static_cast<int>(slot->names.size()) - 1;
  }
  AllSettings read;
  settings_from_json(describe(read), settings_to_json(describe(written)), "test");
  EXPECT_TRUE(differing_settings(describe(read), describe(written)).empty());
}

TEST(Settings, LaterSourcesWin) {
  const SettingsFile file(R"({"max-bounces": 5, "seed": 5})");
  SettingSources sources;
  EXPECT_EQ(resolve(sources).render.path.max_bounces, PathSettings{}.max_bounces);
  sources.scene_json = R"({"max-bounces": 2, "width": 2, "seed": 2, "spp": 2})";
  EXPECT_EQ(resolve(sources).render.path.max_bounces, 2);
  sources.preset = "reference";
  EXPECT_EQ(resolve(sources).render.path.max_bounces, 64);
  sources.file = file.path();
  EXPECT_EQ(resolve(sources).render.path.max_bounces, 5);
  sources.flags = {{"max-bounces", "6"}, {"max-bounces", "7"}};
  const AllSettings settings = resolve(sources);
  EXPECT_EQ(settings.render.path.max_bounces, 7);
  EXPECT_EQ(settings.render.seed, 5);      // file
  EXPECT_EQ(settings.stop.spp, 4096);      // preset
  EXPECT_EQ(settings.render.width, 2);     // scene
  EXPECT_EQ(settings.render.height, 720);  // default
}

TEST(Settings, ErrorsNameTheSource) {
  EXPECT_EQ(message_of([] { resolve({.scene_json = R"({"max-bounces": -1})", .scene_place = "room.json"}); }),
            "room.json: max-bounces is '-1', but must be from 0 to 1024");
  EXPECT_EQ(message_of([] { resolve({.preset = "referense"}); }),
            "there is no preset 'referense'; did you mean 'reference'?");
  const std::string unknown = message_of([] { resolve({.preset = "xyz"}); });
  EXPECT_EQ(unknown.find("there is no preset 'xyz'; there are preview, reference, "), 0u) << unknown;
  EXPECT_EQ(message_of([] {
              resolve({.flags = {{"guide", "cqd"}}});
            }),
            "--guide is 'cqd', but this version has bsdf, cdq and mcpg");
  EXPECT_EQ(message_of([] {
              resolve({.flags = {{"lights", "vcl"}}});
            }),
            "--lights is 'vcl', but this version has uniform, power, light-tree, static-lists, vlc, neeat and mcls");
}

TEST(Settings, EveryPresetIsValid) {
  for (const Preset& preset : presets()) EXPECT_NO_THROW(resolve({.preset = std::string(preset.name)})) << preset.name;
}

TEST(Settings, ReferencePageIsUpToDate) {
  const std::filesystem::path file = std::filesystem::path(RELUME_SOURCE_DIR) / "docs" / "settings.md";
  std::ifstream stream(file);
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  EXPECT_EQ(text, settings_reference()) << "regenerate: relume settings --markdown > docs/settings.md";
}

TEST(SceneOverrides, ReplaceTheEnvironment) {
  Scene scene;
  scene.environment.kind = EnvironmentKind::sun_sky;
  apply({.env = "", .variant = {}}, scene);
  EXPECT_EQ(scene.environment.kind, EnvironmentKind::sun_sky);
  apply({.env = "0.5,1, 2e1", .variant = {}}, scene);
  EXPECT_EQ(scene.environment.kind, EnvironmentKind::constant);
  EXPECT_EQ(scene.environment.color, Rgb(0.5f, 1, 20));
  apply({.env = "none", .variant = {}}, scene);
  EXPECT_EQ(scene.environment.kind, EnvironmentKind::none);
  apply({.env = "studio", .variant = {}}, scene);
  EXPECT_EQ(scene.environment.kind, EnvironmentKind::studio);
  apply({.env = "sun_sky", .variant = {}}, scene);
  EXPECT_EQ(scene.environment.kind, EnvironmentKind::sun_sky);
  EXPECT_GT(scene.environment.sun_sky.sun_scale, 0.0f);
  apply({.env = "sky", .variant = {}}, scene);
  EXPECT_EQ(scene.environment.sun_sky.sun_scale, 0.0f);
}

TEST(SceneOverrides, TurnAndScaleTheEnvironment) {
  Scene scene;
  scene.environment.kind = EnvironmentKind::constant;
  scene.environment.color = {1, 2, 3};
  scene.environment.rotation_rad = 0.5f;
  apply({.env = "", .env_rotation_deg = 90, .env_exposure = 1, .variant = {}}, scene);
  EXPECT_EQ(scene.environment.color, Rgb(2, 4, 6));
  EXPECT_FLOAT_EQ(scene.environment.rotation_rad, 0.5f + kPi / 2);
}

TEST(FitToCamera, ComputesTheMissingDimension) {
  Scene scene;
  scene.cameras.push_back({.name = "wide", .aspect_ratio = 2});
  scene.cameras.push_back({.name = "tall", .aspect_ratio = 0.5f});
  for (Index i = 0; i < 2; ++i) {
    Node node;
    node.camera = i;
    scene.add_node(node);
  }
  const auto size = [&](const char* camera, std::vector<std::pair<std::string, std::string>> flags) {
    flags.emplace_back("camera", camera);
    const SettingSources sources{.flags = flags};
    AllSettings settings = resolve(sources);
    fit_to_camera(settings, sources, scene);
    return IVec2(settings.render.width, settings.render.height);
  };
  const int standard = RenderSettings{}.width;
  EXPECT_EQ(size("wide", {}), IVec2(standard, standard / 2));
  EXPECT_EQ(size("tall", {}), IVec2(standard / 2, standard));
  EXPECT_EQ(size("wide", {{"width", "100"}}), IVec2(100, 50));
  EXPECT_EQ(size("wide", {{"height", "100"}}), IVec2(200, 100));
  EXPECT_EQ(size("wide", {{"width", "100"}, {"height", "100"}}), IVec2(100, 100));
}

TEST(SceneOverrides, RejectInvalidRadiance) {
  Scene scene;
  for (const char* env : {"1,2", "1,2,3,4", "1,-2,3", "1,nan,3", "1,2,inf", "1;2;3", ",,", "nowhere.exr"}) {
    EXPECT_THROW(apply({.env = env, .variant = {}}, scene), Error) << env;
  }
  EXPECT_EQ(
      message_of([&] { apply({.env = "sky.hdr", .variant = {}}, scene); }),
      "env: cannot find file 'sky.hdr'; give an existing one, a radiance such as 1,1,1, or studio, sky, sun_sky or "
      "none");
}

}  // namespace
}  // namespace relume
