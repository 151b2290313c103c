#include "scene_io/gltf/gltf_value.h"

#include <algorithm>

#include <tiny_gltf.h>

namespace relume::gltf {
namespace {

const tinygltf::Value* find(const tinygltf::Value& object, const char* key) {
  if (!object.IsObject() || !object.Has(key)) return nullptr;
  return &object.Get(key);
}

/// First N numbers of the list at `key`.
template <typename V>
V vector_member(const tinygltf::Value& object, const char* key, const V& fallback) {
  const tinygltf::Value* list = find(object, key);
  if (!list || !list->IsArray() || list->ArrayLen() < static_cast<size_t>(V::length())) return fallback;
  V result(0);
  for (int i = 0; i < V::length(); ++i) {
    if (!list->Get(i).IsNumber()) return fallback;
    result[i] = to_float(list->Get(i).GetNumberAsDouble());
  }
  return result;
}

}  // namespace

double number_member(const tinygltf::Value& object, const char* key, double fallback) {
  const tinygltf::Value* value = find(object, key);
  return value && value->IsNumber() ? value->GetNumberAsDouble() : fallback;
}

int integer_member(const tinygltf::Value& object, const char* key, int fallback) {
  const tinygltf::Value* value = find(object, key);
  return value && value->IsInt() ? value->GetNumberAsInt() : fallback;
}

bool boolean_member(const tinygltf::Value& object, const char* key, bool fallback) {
  if (!object.IsObject() || !object.Has(key)) return fallback;
  const tinygltf::Value& value = object.Get(key);
  return value.IsBool() ? value.Get<bool>() : fallback;
}

std::string string_member(const tinygltf::Value& object, const char* key) {
  const tinygltf::Value* value = find(object, key);
  return value && value->IsString() ? value->Get<std::string>() : std::string();
}

const tinygltf::Value* object_member(const tinygltf::Value& object, const char* key) {
  const tinygltf::Value* value = find(object, key);
  return value && value->IsObject() ? value : nullptr;
}

Vec3 vec3_member(const tinygltf::Value& object, const char* key, const Vec3& fallback) {
  return vector_member(object, key, fallback);
}
Vec2 vec2_member(const tinygltf::Value& object, const char* key, const Vec2& fallback) {
  return vector_member(object, key, fallback);
}

float to_float(double value) { return static_cast<float>(std::clamp(value, -1e30, 1e30)); }

Vec3 to_vec3(const std::vector<double>& list, const Vec3& fallback) {
  return list.size() < 3 ? fallback : Vec3(to_float(list[0]), to_float(list[1]), to_float(list[2]));
}

}  // namespace relume::gltf
