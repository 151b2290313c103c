// Writes a glTF file: its JSON and its binary buffer.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/vec.h"
#include "scene_io/staged_files.h"

namespace relume::gltf {

/// JSON that keeps the insertion order of members.
using OutputJson = nlohmann::ordered_json;

/// Double with the same shortest decimal form as `value`: 0.1f is written as 0.1 and reads back as 0.1f.
OutputJson number(float value);
OutputJson numbers(std::span<const float> values);
/// View of the components in sequence.
template <int N>
std::span<const float> flat(const std::vector<glm::vec<N, float>>& values) {
  return {values.empty() ? nullptr : &values.data()->x, static_cast<size_t>(N) * values.size()};
}

inline OutputJson numbers(const Vec2& v) { return numbers(std::span(&v.x, 2)); }
inline OutputJson numbers(const Vec3& v) { return numbers(std::span(&v.x, 3)); }

/// Percent-encoded (RFC 3986) reference to a file in the same folder.
std::string uri_of(const std::string& name);

/// Use of an accessor's bytes (WebGL's buffer targets; none for animation and instances).
enum class BufferTarget : int { none = 0, vertices = 34962, indices = 34963 };

class Output {
 public:
  /// `sources` are never replaced: writing to one of them throws Error.
  Output(const std::filesystem::path& file, std::vector<std::filesystem::path> sources);

  /// Array at `key` of the root, created on first access.
  OutputJson& list(const char* key);
  /// Appends to the array at `key`; returns the index.
  int add(const char* key, OutputJson item);

  /// Adds an accessor of values.size() / components elements of 32-bit floats; `bounds` adds min and max.
  int add_floats(std::span<const float> values, int components, BufferTarget target, bool bounds = false);
  /// Adds an accessor of vertex indices, with 16 bits if sufficient.
  int add_indices(const std::vector<UVec3>& triangles, size_t vertex_count);
  /// Adds an accessor of four joint indices per vertex.
  int add_joints(const std::vector<uint16_t>& joints);
  /// Adds an accessor of unsigned bytes, one per element.
  int add_unsigned_bytes(const std::vector<uint8_t>& values);
  int add_matrices(const std::vector<Mat4>& matrices);
  /// Adds a 4-byte aligned buffer view of arbitrary bytes (an embedded image).
  int add_bytes(std::span<const std::byte> bytes, BufferTarget target = BufferTarget::none);

  void use_extension(const std::string& name, bool required = false);
  void warn(const std::string& sentence) { warnings_.push_back(place() + ": " + sentence); }

  bool binary() const { return binary_; }
  std::string place() const { return file_.string(); }
  /// Adds a file "STEM.SUFFIX" in the output's folder and returns its name. `write` receives a temporary name, which
  /// finish() replaces. Throws Error.
  std::string add_file(const std::string& suffix, const std::function<void(const std::filesystem::path&)>& write);

  OutputJson root;

  /// Writes .glb, or .bin and .gltf. Files are renamed from their temporary names after all are written, the scene's
  /// last: an earlier failure keeps an existing scene intact. Returns the warnings.
  std::vector<std::string> finish();

 private:
  void write_glb(const std::filesystem::path& file, const std::string& text) const;

  std::filesystem::path file_;
  StagedFiles staged_;
  bool binary_;
  std::vector<std::byte> bytes_;
  std::set<std::string> used_;
  std::set<std::string> required_;
  std::vector<std::string> warnings_;
};

}  // namespace relume::gltf
