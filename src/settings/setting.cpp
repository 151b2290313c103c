#include "settings/setting.h"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <type_traits>

#include <fmt/format.h>

#include "relume/error.h"
#include "settings/duration.h"
#include "settings/nearest_name.h"

namespace relume {
namespace {

constexpr double kUnbounded = 1e30;  // the defaults of SettingTraits

[[noreturn]] void fail(const Setting& setting, std::string_view text, std::string_view place,
                       const std::string& problem) {
  throw Error(fmt::format("{}{}{} is '{}', but {}", place, place.empty() ? "" : ": ", setting.name, text, problem));
}

template <typename Number>
std::string number_text(Number value) {
  std::array<char, 64> buffer;
  const auto result = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), result.ptr};
}

/// "from 0 to 1024", "at least 0", "at most 1" or nothing.
std::string range_text(const SettingTraits& traits) {
  const bool low = traits.min > -kUnbounded;
  const bool high = traits.max < kUnbounded;
  // Ten digits give 1000000 rather than 1e+06, and 0.1 rather than the exact value of the double.
  if (low && high) return fmt::format("from {:.10g} to {:.10g}", traits.min, traits.max);
  if (low) return fmt::format("at least {:.10g}", traits.min);
  if (high) return fmt::format("at most {:.10g}", traits.max);
  return {};
}

bool in_range(const SettingTraits& traits, int value) { return value >= traits.min && value <= traits.max; }
/// Bounds such as 0.01 are rounded to float; otherwise the bound itself would be out of range.
bool in_range(const SettingTraits& traits, float value) {
  return value >= static_cast<float>(traits.min) && value <= static_cast<float>(traits.max);
}

template <typename Number>
void check_range(const Setting& setting, Number value, std::string_view text, std::string_view place) {
  if (in_range(setting.traits, value)) return;
  const std::string range = range_text(setting.traits);
  fail(setting, text, place, "must be " + (range.empty() ? "finite" : range));
}

bool parse_bool(const Setting& setting, std::string_view text, std::string_view place) {
  for (const std::string_view word : {"true", "on", "yes", "1"}) {
    if (text == word) return true;
  }
  for (const std::string_view word : {"false", "off", "no", "0"}) {
    if (text == word) return false;
  }
  fail(setting, text, place, "must be true or false");
}

int parse_int(const Setting& setting, std::string_view text, std::string_view place) {
  const std::string_view digits = text.starts_with('+') ? text.substr(1) : text;
  int value = 0;
  const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool complete = end == digits.data() + digits.size();
  if (failure == std::errc::result_out_of_range && complete) {
    const bool negative = digits.starts_with('-');
    const bool bounded = negative ? setting.traits.min > -kUnbounded : setting.traits.max < kUnbounded;
    fail(setting, text, place,
         bounded    ? "must be " + range_text(setting.traits)
         : negative ? fmt::format("must be at least {}", std::numeric_limits<int>::min())
                    : fmt::format("must be at most {}", std::numeric_limits<int>::max()));
  }
  if (failure != std::errc{} || !complete) fail(setting, text, place, "must be an integer");
  check_range(setting, value, text, place);
  return value;
}

float parse_float(const Setting& setting, std::string_view text, std::string_view place) {
  const std::string_view digits = text.starts_with('+') ? text.substr(1) : text;
  float value = 0;
  const auto [end, failure] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  const bool complete = !digits.empty() && end == digits.data() + digits.size();
  if (!complete && setting.traits.unit == "s") {
    value = static_cast<float>(
        parse_duration_s(text, place.empty() ? setting.name : fmt::format("{}: {}", place, setting.name)));
  } else if (!complete || failure == std::errc::invalid_argument) {
    const auto* optional = std::get_if<OptionalNumberRef>(&setting.value);
    fail(setting, text, place, optional ? fmt::format("must be {} or a number", optional->word) : "must be a number");
  } else if (failure == std::errc::result_out_of_range) {
    fail(setting, text, place, "must be a number within single precision");
  }
  check_range(setting, value, text, place);  // also rejects NaN
  return value;
}

std::vector<std::string> names_of(const ChoiceRef& choice) { return {choice.names.begin(), choice.names.end()}; }

std::string parse_choice(const Setting& setting, const ChoiceRef& choice, std::string_view text,
                         std::string_view place) {
  for (const std::string_view name : choice.names) {
    if (name == text) return std::string(name);
  }
  const std::vector<std::string> names = names_of(choice);
  fail(setting, text, place,
       names.size() == 1 ? "this version has only " + names.front() : "this version has " + enumerate(names));
}

template <typename... Cases>
struct Overloaded : Cases... {
  using Cases::operator()...;
};
template <typename... Cases>
Overloaded(Cases...) -> Overloaded<Cases...>;

}  // namespace

SettingList with_prefix(std::string_view prefix, SettingList list) {
  for (Setting& setting : list) setting.name = std::string(prefix) + "." + setting.name;
  return list;
}

const Setting* find_setting(const SettingList& list, std::string_view name) {
  for (const Setting& setting : list) {
    if (setting.name == name) return &setting;
  }
  return nullptr;
}

const Setting& require_setting(const SettingList& list, std::string_view name, std::string_view place) {
  if (const Setting* setting = find_setting(list, name)) return *setting;
  std::vector<std::string> names;
  for (const Setting& setting : list) names.push_back(setting.name);
  throw Error(ErrorCode::not_found,
              fmt::format("{}: there is no setting '{}'{}", place, name, suggestion(name, names)));
}

SettingConstant parse_value(const Setting& setting, std::string_view text, std::string_view place) {
  return std::visit(
      Overloaded{
          [&](bool*) -> SettingConstant { return parse_bool(setting, text, place); },
          [&](int*) -> SettingConstant { return parse_int(setting, text, place); },
          [&](float*) -> SettingConstant { return parse_float(setting, text, place); },
          [&](std::string*) -> SettingConstant { return std::string(text); },
          [&](const ChoiceRef& choice) -> SettingConstant { return parse_choice(setting, choice, text, place); },
          [&](const OptionalNumberRef& number) -> SettingConstant {
            if (text == number.word) return std::string(text);
            return parse_float(setting, text, place);
          },
      },
      setting.value);
}

void assign(const Setting& setting, std::string_view text, std::string_view place) {
  store(setting, parse_value(setting, text, place));
}

void store(const Setting& setting, const SettingConstant& value) {
  std::visit(Overloaded{
                 [&](const ChoiceRef& choice) {
                   const auto& name = std::get<std::string>(value);
                   for (size_t i = 0; i < choice.names.size(); ++i) {
                     if (choice.names[i] == name) *choice.value = static_cast<int>(i);
                   }
                 },
                 [&](const OptionalNumberRef& number) {
                   const auto* given = std::get_if<float>(&value);
                   *number.value = given ? std::optional(*given) : std::nullopt;
                 },
                 [&](auto* target) { *target = std::get<std::remove_pointer_t<decltype(target)>>(value); },
             },
             setting.value);
}

SettingConstant load(const Setting& setting) {
  return std::visit(Overloaded{
                        [](const ChoiceRef& choice) -> SettingConstant {
                          return std::string(choice.names.at(static_cast<size_t>(*choice.value)));
                        },
                        [](const OptionalNumberRef& number) -> SettingConstant {
                          if (*number.value) return **number.value;
                          return std::string(number.word);
                        },
                        [](const auto* source) -> SettingConstant { return *source; },
                    },
                    setting.value);
}

std::string to_string(const SettingConstant& value) {
  return std::visit(Overloaded{
                        [](bool flag) -> std::string { return flag ? "true" : "false"; },
                        [](const std::string& text) -> std::string { return text; },
                        [](auto number) -> std::string { return number_text(number); },
                    },
                    value);
}

std::string to_string(const Setting& setting) { return to_string(load(setting)); }

std::string describe_type(const Setting& setting) {
  const auto number = [&](std::string kind) {
    if (!setting.traits.unit.empty()) kind += " in " + std::string(setting.traits.unit);
    const std::string range = range_text(setting.traits);
    if (range.empty()) return kind;
    return kind + (range.starts_with("from") && setting.traits.unit.empty() ? " " : ", ") + range;
  };
  return std::visit(Overloaded{
                        [](bool*) -> std::string { return "true or false"; },
                        [&](int*) -> std::string { return number("integer"); },
                        [&](float*) -> std::string { return number("number"); },
                        [](std::string*) -> std::string { return "text"; },
                        [&](const OptionalNumberRef& optional) -> std::string {
                          return std::string(optional.word) + " or " + number("number");
                        },
                        [](const ChoiceRef& choice) -> std::string {
                          std::string text;
                          for (const std::string_view name : choice.names) {
                            text += (text.empty() ? "" : ", ") + std::string(name);
                          }
                          return choice.names.size() == 1 ? text : "one of " + text;
                        },
                    },
                    setting.value);
}

std::vector<const Setting*> differing_settings(const SettingList& a, const SettingList& b) {
  std::vector<const Setting*> result;
  for (size_t i = 0; i < a.size(); ++i) {
    if (load(a[i]) != load(b.at(i))) result.push_back(&a[i]);
  }
  return result;
}

}  // namespace relume
