// Strict access to a JSON object: invalid input raises an Error with file, position and remedy.
#pragma once

#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/vec.h"

namespace relume {

class JsonObject {
 public:
  /// `path` is the position of `value` in the file ("camera", "lights[2]"; empty: the whole file). `value` must outlive
  /// this object. Throws Error if it is not an object or has a key outside `valid_keys`; empty `valid_keys` allow any
  /// key.
  JsonObject(const nlohmann::json& value, std::string path, std::string place,
             std::span<const std::string_view> valid_keys);
  JsonObject(const nlohmann::json& value, std::string path, std::string place,
             std::initializer_list<std::string_view> valid_keys)
      : JsonObject(value, std::move(path), std::move(place), std::span(valid_keys.begin(), valid_keys.size())) {}

  bool has(const char* key) const;
  const nlohmann::json& at(const char* key) const;
  std::vector<std::string> keys() const;

  /// Value at `key`, or `fallback` if absent. Throws Error if its type is wrong or it is outside [low, high].
  float number(const char* key, float fallback, float low, float high) const;
  bool boolean(const char* key, bool fallback) const;
  std::string string(const char* key, const std::string& fallback) const;
  Vec3 vec3(const char* key, const Vec3& fallback) const;
  /// A list of three numbers ≥ 0, or one number for all three.
  Rgb rgb(const char* key, const Rgb& fallback) const;
  /// Index of the string at `key` in `names`.
  int choice(const char* key, int fallback, std::span<const std::string_view> names) const;

  JsonObject object(const char* key, std::span<const std::string_view> valid_keys) const;
  JsonObject object(const char* key, std::initializer_list<std::string_view> valid_keys) const {
    return object(key, std::span(valid_keys.begin(), valid_keys.size()));
  }
  /// Objects of the list at `key`; empty if absent.
  std::vector<JsonObject> objects(const char* key, std::span<const std::string_view> valid_keys) const;
  std::vector<JsonObject> objects(const char* key, std::initializer_list<std::string_view> valid_keys) const {
    return objects(key, std::span(valid_keys.begin(), valid_keys.size()));
  }

  /// Throws Error if `key` is absent.
  void require(const char* key) const;
  [[noreturn]] void fail(const std::string& problem) const;
  /// "camera.eye"
  std::string path_of(const std::string& key) const;

 private:
  [[noreturn]] void wrong_type(const char* key, const char* wanted) const;

  const nlohmann::json* value_;
  std::string path_;
  std::string place_;
};

}  // namespace relume
