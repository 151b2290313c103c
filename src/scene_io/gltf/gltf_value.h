// Tolerant access to tinygltf's untyped values (extension objects).
#pragma once

#include <string>
#include <vector>

#include "core/vec.h"

namespace tinygltf {
class Value;
}

namespace relume::gltf {

/// The number at `key` or `fallback`, also if it is of another type.
double number_member(const tinygltf::Value& object, const char* key, double fallback);
/// The integer at `key` or `fallback`, also if it is not an integer.
int integer_member(const tinygltf::Value& object, const char* key, int fallback);
/// The truth value at `key` or `fallback`, also if it is of another type.
bool boolean_member(const tinygltf::Value& object, const char* key, bool fallback);
std::string string_member(const tinygltf::Value& object, const char* key);
/// The object at `key`; nullptr if there is none.
const tinygltf::Value* object_member(const tinygltf::Value& object, const char* key);
Vec3 vec3_member(const tinygltf::Value& object, const char* key, const Vec3& fallback);
Vec2 vec2_member(const tinygltf::Value& object, const char* key, const Vec2& fallback);

/// Doubles of a file as a float: limited to ±1e30, which leaves room to compute with.
float to_float(double value);
/// The first numbers of a list, `fallback` if it is too short.
Vec3 to_vec3(const std::vector<double>& list, const Vec3& fallback);

}  // namespace relume::gltf
