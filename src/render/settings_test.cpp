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

/// A settings file that is removed with the test.
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
  for (const char* name :
       {"width", "height", "spp", "max-bounces", "seed", "threads", "exposure", "camera", "env", "estimator", "lights",
        "guide", "cache", "allocation", "history", "denoise", "time", "error", "tone-map"}) {
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
  for (const Setting& setting : describe(written)) {  // away from every default
    if (auto* const* flag = std::get_if<bool*>(&setting.value)) **flag = !**flag;
    if (auto* const* number = std::get_if<int*>(&setting.value)) **number += **number < setting.traits.max ? 1 : -1;
    if (auto* const* number = std::get_if<float*>(&setting.value)) **number += 0.1f;
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

TEST(Settings, ErrorsSayWhereFrom) {
  EXPECT_EQ(message_of([] { resolve({.scene_json = R"({"max-bounces": -1})", .scene_place = "room.json"}); }),
            "room.json: max-bounces is '-1', but must be from 0 to 1024");
  EXPECT_EQ(message_of([] { resolve({.preset = "referense"}); }),
            "there is no preset 'referense'; did you mean 'reference'?");
  const std::string unknown = message_of([] { resolve({.preset = "xyz"}); });
  EXPECT_EQ(unknown.find("there is no preset 'xyz'; there are preview, reference, "), 0u) << unknown;
  EXPECT_EQ(message_of([] {
              resolve({.flags = {{"guide", "cqd"}}});
            }),
            "--guide is 'cqd', but this version has bsdf and cdq");
  EXPECT_EQ(message_of([] {
              resolve({.flags = {{"lights", "vcl"}}});
            }),
            "--lights is 'vcl', but this version has uniform, power, light-tree, static-lists and vlc");
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
  apply({.env = ""}, scene);
  EXPECT_EQ(scene.environment.kind, EnvironmentKind::sun_sky);
  apply({.env = "0.5,1, 2e1"}, scene);
  EXPECT_EQ(scene.environment.kind, EnvironmentKind::constant);
  EXPECT_EQ(scene.environment.color, Rgb(0.5f, 1, 20));
  apply({.env = "none"}, scene);
  EXPECT_EQ(scene.environment.kind, EnvironmentKind::none);
}

TEST(SceneOverrides, RefuseWhatIsNoRadiance) {
  Scene scene;
  for (const char* env : {"1,2", "1,2,3,4", "1,-2,3", "1,nan,3", "1,2,inf", "1;2;3", ",,", "nowhere.exr"}) {
    EXPECT_THROW(apply({.env = env}, scene), Error) << env;
  }
  EXPECT_EQ(message_of([&] { apply({.env = "sky.hdr"}, scene); }),
            "env: 'sky.hdr' is neither a radiance such as 1,1,1 nor none nor a file that exists");
}

}  // namespace
}  // namespace relume
