// Makes small scene files in memory for tests.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "files/bytes.h"
#include "scene/scene.h"

namespace relume::testing {

using nlohmann::json;

/// Temporary folder, removed with its content on destruction.
class SceneFolder {
 public:
  SceneFolder();
  ~SceneFolder();
  SceneFolder(const SceneFolder&) = delete;
  SceneFolder& operator=(const SceneFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Writes a file and returns its path.
  std::filesystem::path write(const std::string& name, std::string_view content) const;
  std::filesystem::path write(const std::string& name, const Bytes& content) const;

 private:
  std::filesystem::path path_;
};

std::string encode_base64(const Bytes& bytes);
Bytes to_bytes(std::string_view text);
/// "data:…;base64,…"
std::string data_uri(const Bytes& bytes);

/// PNG of `width` × `height` RGBA texels, in rows from the top.
Bytes png(int width, int height, const std::vector<uint8_t>& rgba);
/// PNG of `width` × `height` texels of one RGBA value.
Bytes solid_png(int width, int height, uint8_t r, uint8_t g, uint8_t b, uint8_t a);

/// glTF document with its binary data in one buffer. `doc` may be changed freely.
class GltfBuilder {
 public:
  json doc = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", json::array({{{"nodes", json::array()}}})}};

  template <typename T>
  int view(const std::vector<T>& values) {
    Bytes bytes(values.size() * sizeof(T));
    if (!values.empty()) std::memcpy(bytes.data(), values.data(), bytes.size());
    return add_view(bytes);
  }

  /// Adds an accessor with a separate view. `components`: 1 to 4, or 16 for MAT4.
  template <typename T>
  int accessor(const std::vector<T>& values, int components, int component_type, bool normalized = false) {
    return add_accessor(view(values), values.size() / static_cast<size_t>(components), components, component_type,
                        normalized);
  }
  int floats(const std::vector<float>& values, int components) { return accessor(values, components, 5126); }
  int add_view(const Bytes& bytes);
  int add_accessor(int view, size_t count, int components, int component_type, bool normalized = false);
  /// Appends `object` to `list` and returns its index.
  int add(const char* list, json object);
  /// Adds a node to the scene; returns its index.
  int add_root(json node);
  /// Adds a mesh of one triangle (0,0,0) (1,0,0) (0,1,0), with `extra` merged into its primitive; returns the mesh.
  int add_triangle(const json& extra = json::object());
  /// Adds a triangle with the material in a root node; returns the material.
  int add_triangle_with_material(json material);

  std::string text() const;
  Bytes glb() const;
  /// Loads text().
  Scene load() const;

 private:
  Bytes bin_;
};

/// Loads JSON text as glTF.
Scene load_text(const std::string& text);

/// Message of the Error thrown by `call`; empty if none.
template <typename Call>
std::string error_of(Call call);

/// Whether a sentence contains `part`.
bool mentions(const std::vector<std::string>& sentences, std::string_view part);

}  // namespace relume::testing

#include "relume/error.h"

template <typename Call>
std::string relume::testing::error_of(Call call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return {};
}
