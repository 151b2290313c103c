// Reads tinygltf's untyped values (extension objects), with fallbacks for wrong types.
#pragma once

#include <string>
#include <vector>

#include "core/vec.h"

namespace tinygltf {
class Value;
}

namespace relume::gltf {

/// Number at `key`; `fallback` if absent or of another type.
double number_member(const tinygltf::Value& object, const char* key, double fallback);
/// Integer at `key`; `fallback` if absent or not an integer.
int integer_member(const tinygltf::Value& object, const char* key, int fallback);
/// Boolean at `key`; `fallback` if absent or of another type.
bool boolean_member(const tinygltf::Value& object, const char* key, bool fallback);
std::string string_member(const tinygltf::Value& object, const char* key);
/// Object at `key`; nullptr if absent.
const tinygltf::Value* object_member(const tinygltf::Value& object, const char* key);
Vec3 vec3_member(const tinygltf::Value& object, const char* key, const Vec3& fallback);
Vec2 vec2_member(const tinygltf::Value& object, const char* key, const Vec2& fallback);

/// A file's double as float, clamped to ±1e30 to avoid later overflow.
float to_float(double value);
/// First numbers of a list; `fallback` if it is too short.
Vec3 to_vec3(const std::vector<double>& list, const Vec3& fallback);

}  // namespace relume::gltf
