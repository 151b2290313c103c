#include "settings/settings_json.h"

#include <cmath>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "relume/error.h"

namespace relume {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kDeepestNesting = 8;  // more than the dots in any setting's name

/// A checked value, stored once all others are checked.
struct Assignment {
  const Setting* setting;
  SettingConstant value;
};

Json to_json(const Setting& setting) {
  const SettingConstant value = load(setting);
  if (const auto* flag = std::get_if<bool>(&value)) return *flag;
  if (const auto* text = std::get_if<std::string>(&value)) return *text;
  // Uses the shortest decimal form, so that 0.1f is 0.1 and not 0.10000000149011612.
  return Json::parse(to_string(value));
}

std::string join(const std::string& prefix, const std::string& key) {
  return prefix.empty() ? key : prefix + "." + key;
}

/// "line 3, column 7" of a byte offset that counts from one.
std::string line_and_column(std::string_view text, size_t byte) {
  size_t line = 1;
  size_t column = 1;
  for (size_t i = 0; i + 1 < byte && i < text.size(); ++i) {
    column = text[i] == '\n' ? 1 : column + 1;
    line += text[i] == '\n' ? 1 : 0;
  }
  return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

/// Parses `text` and rejects input that the library accepts silently: repeated keys and deep nesting.
Json parse_object(std::string_view text, const std::string& place) {
  std::vector<std::set<std::string>> keys;
  const auto inspect = [&](int depth, Json::parse_event_t event, Json& parsed) {
    if (depth > kDeepestNesting)
      throw Error(
          place +
          ": the settings are nested more than 8 levels deep; write names with dots, such as \"psf.cell-size\"");
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second) {
      throw Error(place + ": '" + parsed.get<std::string>() + "' is set twice; keep one of them");
    }
    return true;
  };
  Json json;
  try {
    constexpr bool kThrow = true;
    constexpr bool kAllowComments = true;
    json = Json::parse(text.begin(), text.end(), inspect, kThrow, kAllowComments);
  } catch (const Json::parse_error& error) {
    throw Error(place + ": not valid JSON at " + line_and_column(text, error.byte) +
                "; expected an object of settings");
  } catch (const Json::exception&) {  // a number beyond double precision
    throw Error(place + ": not valid JSON: a number exceeds double precision; use a smaller one");
  }
  if (!json.is_object()) throw Error(place + R"(: settings must be a JSON object such as {"max-bounces": 4})");
  return json;
}

/// Text of a JSON value whose type suits the setting.
std::string value_text(const Setting& setting, const Json& json, const std::string& place) {
  const bool wants_bool = std::holds_alternative<bool*>(setting.value);
  const bool wants_number = std::holds_alternative<int*>(setting.value) ||
                            std::holds_alternative<float*>(setting.value) ||
                            std::holds_alternative<OptionalNumberRef>(setting.value);
  if (json.is_string() && !wants_bool) return json.get<std::string>();
  if (json.is_boolean() && wants_bool) return json.get<bool>() ? "true" : "false";
  if (json.is_number() && wants_number) {
    const auto number = json.get<double>();
    // 4.0 and 1e3 are valid integers.
    if (std::abs(number) < 1e9 && number == std::trunc(number)) return std::to_string(static_cast<int64_t>(number));
    return json.dump();
  }
  throw Error(fmt::format("{}: {} is {}; expected {}", place, setting.name,
                          json.dump(-1, ' ', false, Json::error_handler_t::replace), describe_type(setting)));
}

void collect(const SettingList& list, const Json& object, const std::string& prefix, const std::string& place,
             std::vector<Assignment>& assignments) {
  for (const auto& [key, json] : object.items()) {
    const std::string name = join(prefix, key);
    if (json.is_object() && find_setting(list, name) == nullptr) {
      collect(list, json, name, place, assignments);
      continue;
    }
    const Setting& setting = require_setting(list, name, place);
    for (const Assignment& earlier : assignments) {
      if (earlier.setting == &setting) throw Error(place + ": '" + name + "' is set twice; keep one of them");
    }
    assignments.push_back({&setting, parse_value(setting, value_text(setting, json, place), place)});
  }
}

}  // namespace

std::string settings_to_json(const SettingList& list) {
  Json object = Json::object();
  for (const Setting& setting : list) object[setting.name] = to_json(setting);
  return object.dump(2, ' ', false, Json::error_handler_t::replace);
}

void settings_from_json(const SettingList& list, std::string_view json, std::string_view place) {
  std::vector<Assignment> assignments;
  collect(list, parse_object(json, std::string(place)), {}, std::string(place), assignments);
  for (const auto& [setting, value] : assignments) store(*setting, value);
}

void settings_from_file(const SettingList& list, const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::error_code failure;
  if (!stream || std::filesystem::is_directory(file, failure)) {
    throw Error(file.string() + ": the settings file cannot be read; check its name and permissions");
  }
  const std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  settings_from_json(list, text, file.string());
}

}  // namespace relume
