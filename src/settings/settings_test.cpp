#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>

#include "relume/error.h"
#include "settings/duration.h"
#include "settings/nearest_name.h"
#include "settings/setting.h"
#include "settings/settings_docs.h"
#include "settings/settings_json.h"
#include "settings/text_list.h"

namespace relume {
namespace {

enum class Shape : int { round, square };

struct Sample {
  bool flag = true;
  int count = 4;
  float size = 0.1f;
  float pause_s = 0;
  std::string name = "a \"quoted\" name";
  Shape shape = Shape::round;
};

SettingList describe(Sample& s) {
  return {
      {"flag", &s.flag, "A flag"},
      {"count", &s.count, "A count", {.min = 0, .max = 1024}},
      {"grid.size", &s.size, "A size | with a bar", {.min = 0, .unit = "m", .biases = true}},
      {"grid.pause", &s.pause_s, "A pause", {.unit = "s", .resets_history = false}},
      {"name", &s.name, "A name"},
      {"shape", choice(s.shape, {"round", "square"}), "A shape"},
  };
}

std::string message_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

std::string assign_message(const char* name, const char* text) {
  Sample sample;
  return message_of([&] { assign(require_setting(describe(sample), name, "here"), text, "here"); });
}

std::string json_message(const char* json) {
  Sample sample;
  return message_of([&] { settings_from_json(describe(sample), json, "file.json"); });
}

TEST(Setting, AssignsEveryType) {
  Sample sample;
  const SettingList list = describe(sample);
  assign(require_setting(list, "flag", ""), "off", "");
  assign(require_setting(list, "count", ""), "+7", "");
  assign(require_setting(list, "grid.size", ""), "2.5e-3", "");
  assign(require_setting(list, "grid.pause", ""), "1.5min", "");
  assign(require_setting(list, "name", ""), "", "");
  assign(require_setting(list, "shape", ""), "square", "");
  EXPECT_FALSE(sample.flag);
  EXPECT_EQ(sample.count, 7);
  EXPECT_EQ(sample.size, 2.5e-3f);
  EXPECT_EQ(sample.pause_s, 90);
  EXPECT_EQ(sample.name, "");
  EXPECT_EQ(sample.shape, Shape::square);
}

TEST(Setting, AWordMayReplaceANumber) {
  std::optional<float> value;
  const SettingList list{{"gain", OptionalNumberRef{&value, "auto"}, "A gain", {.min = -4, .max = 4, .unit = "stops"}}};
  const Setting& gain = list[0];
  EXPECT_EQ(to_string(gain), "auto");
  EXPECT_EQ(describe_type(gain), "auto or number in stops, from -4 to 4");
  assign(gain, "1.5", "");
  EXPECT_EQ(value, 1.5f);
  EXPECT_EQ(to_string(gain), "1.5");
  settings_from_json(list, R"({"gain": -2})", "here");
  EXPECT_EQ(value, -2.0f);
  settings_from_json(list, R"({"gain": "auto"})", "here");
  EXPECT_FALSE(value);
  EXPECT_EQ(message_of([&] { assign(gain, "much", "here"); }), "here: gain is 'much', but must be auto or a number");
  EXPECT_EQ(message_of([&] { assign(gain, "5", "here"); }), "here: gain is '5', but must be from -4 to 4");
}

TEST(Setting, RejectsInvalidValues) {
  EXPECT_EQ(assign_message("count", "-1"), "here: count is '-1', but must be from 0 to 1024");
  EXPECT_EQ(assign_message("count", "99999999999999"), "here: count is '99999999999999', but must be from 0 to 1024");
  EXPECT_EQ(assign_message("count", "4.5"), "here: count is '4.5', but must be an integer");
  EXPECT_EQ(assign_message("count", ""), "here: count is '', but must be an integer");
  EXPECT_EQ(assign_message("grid.size", "-0.1"), "here: grid.size is '-0.1', but must be at least 0");
  EXPECT_EQ(assign_message("grid.size", "nan"), "here: grid.size is 'nan', but must be at least 0");
  EXPECT_EQ(assign_message("grid.size", "inf"), "here: grid.size is 'inf', but must be at least 0");
  EXPECT_EQ(assign_message("grid.size", "1m"), "here: grid.size is '1m', but must be a number");
  EXPECT_EQ(assign_message("flag", "maybe"), "here: flag is 'maybe', but must be true or false");
  EXPECT_EQ(assign_message("shape", "oval"), "here: shape is 'oval', but this version has round and square");
  EXPECT_EQ(assign_message("conut", "1"), "here: there is no setting 'conut'; did you mean 'count'?");
}

TEST(Setting, TakesItsBounds) {
  float value = 1;
  const Setting setting{"value", &value, "", {.min = 0.01, .max = 0.7}};
  for (const char* bound : {"0.01", "0.7"}) EXPECT_NO_THROW(assign(setting, bound, "")) << bound;
  EXPECT_THROW(assign(setting, "0.00999", ""), Error);
  int seed = 0;
  const Setting unbounded{"seed", &seed, "", {.min = 0}};
  EXPECT_EQ(message_of([&] { assign(unbounded, "3000000000", "here"); }),
            "here: seed is '3000000000', but must be at most 2147483647");
  EXPECT_EQ(message_of([&] { assign(unbounded, "-3000000000", "here"); }),
            "here: seed is '-3000000000', but must be at least 0");
}

TEST(Setting, TextRoundTripsEveryFloat) {
  Sample sample;
  const SettingList list = describe(sample);
  const Setting& size = require_setting(list, "grid.size", "");
  for (const float value : {0.1f, 1.0f / 3.0f, 1e-38f, 16777216.0f, std::nextafter(1.0f, 2.0f)}) {
    sample.size = value;
    const std::string text = to_string(size);
    sample.size = -1;
    assign(size, text, "");
    EXPECT_EQ(sample.size, value) << text;
  }
}

TEST(Setting, Compares) {
  Sample a;
  Sample b;
  b.count = 5;
  b.shape = Shape::square;
  const SettingList list = describe(b);
  const auto differing = differing_settings(list, describe(a));
  ASSERT_EQ(differing.size(), 2u);
  EXPECT_EQ(differing[0]->name, std::string("count"));
  EXPECT_EQ(differing[1]->name, std::string("shape"));
  a = b;
  EXPECT_TRUE(differing_settings(describe(a), describe(b)).empty());
}

TEST(SettingsJson, RoundTripsAllTypes) {
  Sample written{false, 1024, 1.0f / 3.0f, 2.5f, "line\nbreak \xc3\xa9 \"", Shape::square};
  Sample read;
  settings_from_json(describe(read), settings_to_json(describe(written)), "test");
  EXPECT_TRUE(differing_settings(describe(read), describe(written)).empty());
}

TEST(SettingsJson, WritesShortNumbersInOrder) {
  Sample sample{true, 4, 0.1f, 0, "n"};
  EXPECT_EQ(settings_to_json(describe(sample)),
            "{\n  \"flag\": true,\n  \"count\": 4,\n  \"grid.size\": 0.1,\n  \"grid.pause\": 0,\n  \"name\": \"n\",\n"
            "  \"shape\": \"round\"\n}");
}

TEST(SettingsJson, ReadsNestedNamesCommentsAndDurations) {
  Sample sample;
  settings_from_json(describe(sample), "{ // comment\n\"grid\": {\"size\": 2, \"pause\": \"500ms\"}, \"count\": 8.0}",
                     "test");
  EXPECT_EQ(sample.size, 2);
  EXPECT_EQ(sample.pause_s, 0.5f);
  EXPECT_EQ(sample.count, 8);
}

TEST(SettingsJson, NamesPlaceAndRemedy) {
  EXPECT_EQ(json_message("{\n  \"count\": 1,\n  }"),
            "file.json: not valid JSON at line 3, column 3; expected an object of settings");
  EXPECT_EQ(json_message("{\"Count\": 1}"), "file.json: there is no setting 'Count'; did you mean 'count'?");
  EXPECT_EQ(json_message("{\"grid\": {\"sise\": 1}}"),
            "file.json: there is no setting 'grid.sise'; did you mean 'grid.size'?");
  EXPECT_EQ(json_message("{\"zzzzzz\": 1}"),
            "file.json: there is no setting 'zzzzzz'; there are flag, count, grid.size, grid.pause, name and shape");
  EXPECT_EQ(json_message("{\"count\": 1025}"), "file.json: count is '1025', but must be from 0 to 1024");
  EXPECT_EQ(json_message("{\"flag\": 1}"), "file.json: flag is 1; expected true or false");
  EXPECT_EQ(json_message("{\"count\": [1]}"), "file.json: count is [1]; expected integer from 0 to 1024");
  EXPECT_EQ(json_message("{\"count\": 1, \"count\": 2}"), "file.json: 'count' is set twice; keep one of them");
  EXPECT_EQ(json_message("{\"grid.size\": 1, \"grid\": {\"size\": 2}}"),
            "file.json: 'grid.size' is set twice; keep one of them");
  EXPECT_EQ(json_message("[1]"), "file.json: settings must be a JSON object such as {\"max-bounces\": 4}");
  EXPECT_EQ(json_message("{\"count\": 1e999}"),
            "file.json: not valid JSON: a number exceeds double precision; use a smaller one");
}

TEST(SettingsJson, SurvivesHostileInput) {
  EXPECT_NE(json_message(std::string(100000, '[').c_str()), "no error");
  std::string nested;
  for (int i = 0; i < 100000; ++i) nested += "{\"grid\":";
  EXPECT_NE(json_message(nested.c_str()), "no error");
  EXPECT_NE(json_message("{\"name\": \"\xff\xfe\"}"), "no error");
  EXPECT_NE(json_message(""), "no error");
}

TEST(SettingsJson, ChangesNothingOnError) {
  Sample sample;
  EXPECT_THROW(settings_from_json(describe(sample), "{\"count\": 9, \"flag\": 3}", "test"), Error);
  EXPECT_EQ(sample.count, 4);
}

TEST(SettingsJson, NamesAMissingFile) {
  Sample sample;
  EXPECT_EQ(message_of([&] { settings_from_file(describe(sample), "/nowhere/s.json"); }),
            "/nowhere/s.json: the settings file cannot be read; check its name and permissions");
  EXPECT_THROW(settings_from_file(describe(sample), std::filesystem::temp_directory_path()), Error);
}

TEST(SettingsDocs, TableHasARowForEachSetting) {
  Sample sample;
  const std::string text = settings_to_markdown({{"Title", "Summary.", describe(sample)}});
  EXPECT_NE(text.find("## Title\n\nSummary.\n\n| flag |"), std::string::npos);
  EXPECT_NE(text.find("| `--grid.size` | number in m, at least 0 | `0.1` | yes | yes | A size \\| with a bar |"),
            std::string::npos)
      << text;
  EXPECT_NE(text.find("| `--grid.pause` | number in s | `0` | | | A pause |"), std::string::npos) << text;
  EXPECT_NE(text.find("| `--shape` | one of round, square | `round` | yes | | A shape |"), std::string::npos);
}

TEST(Duration, ReadsCommonNotations) {
  EXPECT_DOUBLE_EQ(parse_duration_s("10", "t"), 10);
  EXPECT_DOUBLE_EQ(parse_duration_s("10s", "t"), 10);
  EXPECT_DOUBLE_EQ(parse_duration_s("500ms", "t"), 0.5);
  EXPECT_DOUBLE_EQ(parse_duration_s("2m", "t"), 120);
  EXPECT_DOUBLE_EQ(parse_duration_s("2min", "t"), 120);
  EXPECT_DOUBLE_EQ(parse_duration_s("1.5h", "t"), 5400);
  EXPECT_DOUBLE_EQ(parse_duration_s("1h30min5s", "t"), 5405);
}

TEST(Duration, RejectsOtherText) {
  for (const char* text : {"", "s", "-1s", "-0", "1x", "1s2", "nan", "inf", "1 s", "1e400", "10 "}) {
    EXPECT_THROW(parse_duration_s(text, "t"), Error) << text;
  }
  EXPECT_EQ(message_of([] { parse_duration_s("soon", "--time"); }),
            "--time: 'soon' is not a duration; write 10s, 500ms, 2min or 1h30min");
}

TEST(NearestName, FindsTyposAndBeginnings) {
  const std::vector<std::string> names = {"cornell", "cornell-water", "corridor", "city"};
  EXPECT_EQ(nearest_name("cornel", names), "cornell");
  EXPECT_EQ(nearest_name("CORRIDOR", names), "corridor");
  EXPECT_EQ(nearest_name("ctiy", names), "city");
  EXPECT_EQ(nearest_name("water", names), "cornell-water");
  EXPECT_EQ(nearest_name("teapot", names), "");
  EXPECT_EQ(nearest_name("", names), "");
  EXPECT_EQ(suggestion("x", {"a", "b"}), "; did you mean 'a'?");
  EXPECT_EQ(suggestion("xyz", {"a", "b"}), "; there are a and b");
  EXPECT_EQ(suggestion("xyz", {"path"}), "; there is path");
}

TEST(TextList, PartsBetweenCommasWithoutBlanks) {
  using Parts = std::vector<std::string_view>;
  EXPECT_EQ(split_at_commas(" a,\tb c ,, d\r"), (Parts{"a", "b c", "d"}));
  EXPECT_EQ(split_at_commas(" , ,"), Parts{});
  EXPECT_EQ(trimmed(" \t "), "");
}

}  // namespace
}  // namespace relume
