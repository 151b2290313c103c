#include "scene_io/relume_json/json_object.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "relume/error.h"

namespace relume {
namespace {

using nlohmann::json;

constexpr double kLargest = 1e30;

bool is_usable_number(const json& value) { return value.is_number() && std::fabs(value.get<double>()) <= kLargest; }

bool is_vec3(const json& value) {
  return value.is_array() && value.size() == 3 && std::all_of(value.begin(), value.end(), is_usable_number);
}

Vec3 to_vec3(const json& value) { return {value[0].get<float>(), value[1].get<float>(), value[2].get<float>()}; }

}  // namespace

JsonObject::JsonObject(const json& value, std::string path, std::string place,
                       std::span<const std::string_view> valid_keys)
    : value_(&value), path_(std::move(path)), place_(std::move(place)) {
  if (!value.is_object())
    fail(fmt::format("{} must be an object, not {}", path_.empty() ? "the file" : path_, value.type_name()));
  if (valid_keys.empty()) return;
  for (const auto& [key, ignored] : value.items()) {
    if (std::find(valid_keys.begin(), valid_keys.end(), key) == valid_keys.end())
      fail(fmt::format("unknown key '{}'; valid here are {}", path_of(key), fmt::join(valid_keys, ", ")));
  }
}

void JsonObject::fail(const std::string& problem) const { throw Error(place_ + ": " + problem); }

std::string JsonObject::path_of(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }

void JsonObject::wrong_type(const char* key, const char* wanted) const {
  fail(fmt::format("{} must be {}, not {}", path_of(key), wanted, at(key).dump()));
}

bool JsonObject::has(const char* key) const { return value_->contains(key); }

const json& JsonObject::at(const char* key) const {
  require(key);
  return *value_->find(key);
}

void JsonObject::require(const char* key) const {
  if (!has(key)) fail(fmt::format("{} is missing; add it", path_of(key)));
}

std::vector<std::string> JsonObject::keys() const {
  std::vector<std::string> keys;
  for (const auto& [key, ignored] : value_->items()) keys.push_back(key);
  return keys;
}

float JsonObject::number(const char* key, float fallback, float low, float high) const {
  if (!has(key)) return fallback;
  if (!is_usable_number(at(key))) wrong_type(key, "a number");
  const float value = at(key).get<float>();
  if (value < low || value > high)
    fail(fmt::format("{} is {}, but must be from {} to {}", path_of(key), value, low, high));
  return value;
}

bool JsonObject::boolean(const char* key, bool fallback) const {
  if (!has(key)) return fallback;
  if (!at(key).is_boolean()) wrong_type(key, "true or false");
  return at(key).get<bool>();
}

std::string JsonObject::string(const char* key, const std::string& fallback) const {
  if (!has(key)) return fallback;
  if (!at(key).is_string()) wrong_type(key, "a string");
  return at(key).get<std::string>();
}

Vec3 JsonObject::vec3(const char* key, const Vec3& fallback) const {
  if (!has(key)) return fallback;
  if (!is_vec3(at(key))) wrong_type(key, "a list of three numbers");
  return to_vec3(at(key));
}

Rgb JsonObject::rgb(const char* key, const Rgb& fallback) const {
  if (!has(key)) return fallback;
  const json& value = at(key);
  if (!is_usable_number(value) && !is_vec3(value)) wrong_type(key, "a number or a list of three numbers");
  const Rgb result = value.is_number() ? Rgb(value.get<float>()) : to_vec3(value);
  if (min_component(result) < 0) fail(fmt::format("{} is {}, but must not be negative", path_of(key), value.dump()));
  return result;
}

int JsonObject::choice(const char* key, int fallback, std::span<const std::string_view> names) const {
  if (!has(key)) return fallback;
  const std::string name = string(key, "");
  const auto it = std::find(names.begin(), names.end(), name);
  if (it == names.end()) fail(fmt::format("{} is '{}'; valid are {}", path_of(key), name, fmt::join(names, ", ")));
  return static_cast<int>(it - names.begin());
}

JsonObject JsonObject::object(const char* key, std::span<const std::string_view> valid_keys) const {
  return {at(key), path_of(key), place_, valid_keys};
}

std::vector<JsonObject> JsonObject::objects(const char* key, std::span<const std::string_view> valid_keys) const {
  std::vector<JsonObject> objects;
  if (!has(key)) return objects;
  const json& list = at(key);
  if (!list.is_array()) wrong_type(key, "a list");
  for (size_t i = 0; i < list.size(); ++i)
    objects.emplace_back(list[i], fmt::format("{}[{}]", path_of(key), i), place_, valid_keys);
  return objects;
}

}  // namespace relume
