// Checks written glTF files.
#pragma once

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace relume::testing {

inline std::string contents(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

inline nlohmann::json written_json(const std::filesystem::path& file) { return nlohmann::json::parse(contents(file)); }

/// Checks that every view is aligned in the one buffer and every accessor fills its view.
inline void expect_sound_accessors(const nlohmann::json& gltf, size_t buffer_size) {
  ASSERT_EQ(gltf["buffers"].size(), 1u);
  EXPECT_EQ(gltf["buffers"][0]["byteLength"], buffer_size);
  for (const nlohmann::json& view : gltf["bufferViews"]) {
    EXPECT_EQ(view["byteOffset"].get<size_t>() % 4, 0u);
    EXPECT_LE(view["byteOffset"].get<size_t>() + view["byteLength"].get<size_t>(), buffer_size);
  }
  const std::map<std::string, size_t> components = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}, {"MAT4", 16}};
  for (const nlohmann::json& accessor : gltf["accessors"]) {
    const size_t size = accessor["componentType"] == 5121 ? 1 : accessor["componentType"] == 5123 ? 2 : 4;
    EXPECT_EQ(accessor["count"].get<size_t>() * components.at(accessor["type"]) * size,
              gltf["bufferViews"][accessor["bufferView"].get<size_t>()]["byteLength"]);
  }
}

}  // namespace relume::testing
