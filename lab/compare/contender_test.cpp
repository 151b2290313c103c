#include "compare/contender.h"

#include <fstream>

#include <gtest/gtest.h>

#include "relume/error.h"

namespace relume {
namespace {

using Pairs = std::vector<std::pair<std::string, std::string>>;

std::string error_of(const char* text) {
  try {
    parse_contenders(text, "--techniques");
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Contender, PresetsFilesAndSettings) {
  const auto list = parse_contenders(
      "preview, folder/mine.json,uniform=lights:uniform,few=preview,max-bounces:2,seed:3,default", "-t");
  ASSERT_EQ(list.size(), 5u);
  EXPECT_EQ(list[0].name, "preview");
  EXPECT_EQ(list[0].preset, "preview");
  EXPECT_EQ(list[1].name, "mine");
  EXPECT_EQ(list[1].file, "folder/mine.json");
  EXPECT_EQ(list[2].name, "uniform");
  EXPECT_EQ(list[2].preset, "");
  EXPECT_EQ(list[2].settings, (Pairs{{"lights", "uniform"}}));
  EXPECT_EQ(list[3].name, "few");
  EXPECT_EQ(list[3].preset, "preview");
  EXPECT_EQ(list[3].settings, (Pairs{{"max-bounces", "2"}, {"seed", "3"}}));
  EXPECT_EQ(list[4].name, "default");
  EXPECT_EQ(list[4].preset, "");
}

TEST(Contender, RecognisesFilesByExtensionInAnyCase) {
  const auto list = parse_contenders("Mine.JSON,a/image.Exr", "-t");
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].file, "Mine.JSON");
  EXPECT_EQ(list[1].name, "image");
}

TEST(Contender, TechniquesAreNamedByTheirChoice) {
  const auto list = parse_contenders("psf,apsf+apg,adaptive,fast=bmfr,lights:vlc", "-t");
  ASSERT_EQ(list.size(), 4u);
  EXPECT_EQ(list[0].settings, (Pairs{{"cache", "psf"}}));
  EXPECT_EQ(list[1].settings, (Pairs{{"cache", "apsf+apg"}}));
  EXPECT_EQ(list[2].preset, "adaptive");  // presets take precedence
  EXPECT_EQ(list[3].name, "fast");
  EXPECT_EQ(list[3].settings, (Pairs{{"denoise", "bmfr"}, {"lights", "vlc"}}));
  EXPECT_NE(error_of("none").find("there is no preset 'none'"), std::string::npos);  // several slots have it
}

TEST(Contender, ErrorsAreOneSentence) {
  EXPECT_NE(error_of("").find("--techniques: there is nothing to compare"), std::string::npos);
  EXPECT_NE(error_of("prewiev").find("did you mean 'preview'"), std::string::npos);
  EXPECT_NE(error_of("lights:uniform").find("needs a name before it"), std::string::npos);
  EXPECT_NE(error_of("preview,preview").find("two contenders are called 'preview'"), std::string::npos);
  EXPECT_NE(error_of("a=").find("is not NAME="), std::string::npos);
  EXPECT_NE(error_of("a=lights:").find("is not KEY:VALUE"), std::string::npos);
}

TEST(Contender, InlineSettingsWinOverFlagsAndFlagsOverPresets) {
  SettingSources common;
  common.flags = {{"max-bounces", "5"}, {"width", "64"}};
  const auto list = parse_contenders("preview,mine=preview,max-bounces:2", "-t");
  EXPECT_EQ(resolve_contender(list[0], common).render.path.max_bounces, 5);
  EXPECT_EQ(resolve_contender(list[1], common).render.path.max_bounces, 2);
  EXPECT_EQ(resolve_contender(list[1], common).render.width, 64);
}

TEST(Contender, FilesCannotSetComparisonOptions) {
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "relume_contender_test.json";
  std::ofstream(file) << R"({"width": 17, "spp": 3, "lights": "uniform"})";
  SettingSources common;
  common.flags = {{"width", "64"}};
  const AllSettings settings = resolve_contender(parse_contenders(file.string(), "-t")[0], common);
  EXPECT_EQ(settings.render.width, 64);
  EXPECT_EQ(settings.stop.spp, 0);
  EXPECT_EQ(settings.render.lights, LightSelectionChoice::uniform);
  std::filesystem::remove(file);
}

TEST(Contender, UnknownAndSharedSettingsAreRefused) {
  const auto unknown = parse_contenders("a=lihgts:uniform", "-t");
  EXPECT_THROW(resolve_contender(unknown[0], {}), Error);
  const auto shared = parse_contenders("a=width:4", "-t");
  try {
    resolve_contender(shared[0], {});
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "a: width is common to all contenders; give it as --width");
  }
}

TEST(Contender, SettingsAlone) {
  EXPECT_EQ(parse_settings("lights:light-tree, psf.cell-size:4", "-s"),
            (Pairs{{"lights", "light-tree"}, {"psf.cell-size", "4"}}));
  EXPECT_TRUE(parse_settings("", "-s").empty());
  for (const char* wrong : {"lights", "lights:", ":power"}) {
    try {
      parse_settings(wrong, "-s");
      FAIL() << wrong;
    } catch (const Error& error) {
      EXPECT_EQ(error.what(), "-s: '" + std::string(wrong) + "' is not KEY:VALUE, such as lights:vlc");
    }
  }
}

TEST(ReferenceSettings, CommonFlagsDoNotBiasThem) {
  SettingSources common;
  common.scene_json = R"({"guide": "cdq", "svgf.levels": 2})";
  common.flags = {{"cache", "psf"},      {"denoise", "svgf"},     {"history", "none"},
                  {"lights", "uniform"}, {"estimator", "path"},   {"width", "64"},
                  {"max-bounces", "5"},  {"psf.cell-size", "20"}, {"texture-filter", "encoded"}};
  const ReferenceSettings reference = resolve_reference(common, {}, {});
  const RenderSettings& render = reference.settings.render;
  const RenderSettings defaults;
  EXPECT_EQ(render.cache, CacheChoice::none);
  EXPECT_EQ(render.denoise, DenoiseChoice::none);
  EXPECT_EQ(render.history, HistoryChoice::accumulate);
  EXPECT_EQ(render.lights, LightSelectionChoice::power);
  EXPECT_EQ(render.guide, GuideChoice::bsdf);
  EXPECT_EQ(render.svgf.levels, defaults.svgf.levels);
  EXPECT_EQ(render.width, 64);
  EXPECT_EQ(render.texture_filter, TextureFilter::encoded);
  EXPECT_EQ(render.path.max_bounces, 5);
  // Settings that the reference shares are not listed, and the scene's settings are no flags.
  const Pairs left_out{
      {"psf.cell-size", "20"}, {"lights", "uniform"}, {"cache", "psf"}, {"history", "none"}, {"denoise", "svgf"}};
  EXPECT_EQ(reference.left_out, left_out);
}

TEST(ReferenceSettings, EverySlotIsThePresets) {
  AllSettings preset = resolve({.preset = "reference"});
  for (const Setting& slot : describe_slots(preset.render)) {
    for (const std::string_view name : std::get<ChoiceRef>(slot.value).names) {
      SettingSources common;
      common.flags = {{slot.name, std::string(name)}};
      AllSettings settings = resolve_reference(common, {}, {}).settings;
      EXPECT_EQ(to_string(require_setting(describe(settings), slot.name, "")), to_string(slot)) << name;
    }
  }
}

TEST(ReferenceSettings, OwnSettingsWin) {
  SettingSources common;
  common.flags = {{"lights", "uniform"}, {"cache", "psf"}};
  const ReferenceSettings reference =
      resolve_reference(common, {}, {{"lights", "light-tree"}, {"cache", "psf"}, {"max-bounces", "9"}});
  EXPECT_EQ(reference.settings.render.lights, LightSelectionChoice::light_tree);
  EXPECT_EQ(reference.settings.render.cache, CacheChoice::psf);
  EXPECT_EQ(reference.settings.render.path.max_bounces, 9);
  EXPECT_EQ(reference.left_out, (Pairs{{"lights", "uniform"}}));
  EXPECT_THROW(resolve_reference(common, {}, {{"lihgts", "power"}}), Error);
  try {
    resolve_reference(common, {}, {{"width", "4"}});
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "--reference-settings: width is common to all contenders; give it as --width");
  }
}

TEST(ReferenceSettings, UseTheMostBouncesOfAnyContender) {
  SettingSources common;
  common.flags = {{"max-bounces", "7"}};
  AllSettings few;
  AllSettings more;
  few.render.path.max_bounces = 2;
  more.render.path.max_bounces = 4;
  EXPECT_EQ(resolve_reference(common, {few, more, few}, {}).settings.render.path.max_bounces, 4);
}

TEST(Contender, Images) {
  const auto list = parse_image_contenders("cycles=out/a.exr,b.exr", "--image");
  ASSERT_EQ(list.size(), 2u);
  EXPECT_EQ(list[0].name, "cycles");
  EXPECT_EQ(list[0].file, "out/a.exr");
  EXPECT_EQ(list[1].name, "b");
  EXPECT_THROW(parse_image_contenders("a=x.exr,a=y.exr", "--image"), Error);
  EXPECT_TRUE(parse_image_contenders("", "--image").empty());
}

}  // namespace
}  // namespace relume
