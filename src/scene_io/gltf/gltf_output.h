// A glTF file on its way out: its JSON and its binary buffer.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <list>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/vec.h"
#include "files/atomic_file.h"

namespace relume::gltf {

/// Members keep the order in which they are added.
using OutputJson = nlohmann::ordered_json;

/// The double whose shortest decimal form is that of `value`: 0.1f is written as 0.1 and reads back as 0.1f.
OutputJson number(float value);
OutputJson numbers(std::span<const float> values);
/// Components one after another.
template <int N>
std::span<const float> flat(const std::vector<glm::vec<N, float>>& values) {
  return {values.empty() ? nullptr : &values.data()->x, static_cast<size_t>(N) * values.size()};
}

inline OutputJson numbers(const Vec2& v) { return numbers(std::span(&v.x, 2)); }
inline OutputJson numbers(const Vec3& v) { return numbers(std::span(&v.x, 3)); }

/// A reference to a file that lies beside this one, percent-encoded (RFC 3986).
std::string uri_of(const std::string& name);

/// What the bytes of an accessor are for (WebGL's buffer targets; none for animation and instances).
enum class BufferTarget : int { none = 0, vertices = 34962, indices = 34963 };

class Output {
 public:
  /// No file of `sources` is replaced.
  Output(const std::filesystem::path& file, std::vector<std::filesystem::path> sources);

  /// The array at `key` of the root, created when it is first asked for.
  OutputJson& list(const char* key);
  /// Appends to the array at `key`; returns the position.
  int add(const char* key, OutputJson item);

  /// Accessor over values.size() / components elements of 32-bit floats; `bounds` adds min and max.
  int add_floats(std::span<const float> values, int components, BufferTarget target, bool bounds = false);
  /// Accessor over vertex indices, in 16 bits where that suffices.
  int add_indices(const std::vector<UVec3>& triangles, size_t vertex_count);
  /// Accessor over four numbers of joints a vertex.
  int add_joints(const std::vector<uint16_t>& joints);
  /// Accessor over unsigned bytes, one an element.
  int add_unsigned_bytes(const std::vector<uint8_t>& values);
  int add_matrices(const std::vector<Mat4>& matrices);
  /// Buffer view over bytes of any kind (an embedded image); 4-byte aligned.
  int add_bytes(std::span<const std::byte> bytes, BufferTarget target = BufferTarget::none);

  void use_extension(const std::string& name, bool required = false);
  void warn(const std::string& sentence) { warnings_.push_back(place() + ": " + sentence); }

  bool binary() const { return binary_; }
  std::string place() const { return file_.string(); }
  /// `write` writes a file that is to lie beside this one, "STEM.SUFFIX", under the name that it is told; finish()
  /// gives it its own, which is returned. Throws Error.
  std::string add_file(const std::string& suffix, const std::function<void(const std::filesystem::path&)>& write);

  OutputJson root;

  /// Writes .glb, or .bin and .gltf. Only when everything is written do files get their names, the scene's last: what
  /// fails before leaves an older scene whole. Returns the warnings.
  std::vector<std::string> finish();

 private:
  void write_staged(const std::filesystem::path& target,
                    const std::function<void(const std::filesystem::path&)>& write);
  void write_glb(const std::filesystem::path& file, const std::string& text) const;

  std::filesystem::path file_;
  std::vector<std::filesystem::path> sources_;
  std::list<PendingFile> staged_;
  bool binary_;
  std::vector<std::byte> bytes_;
  std::set<std::string> used_;
  std::set<std::string> required_;
  std::vector<std::string> warnings_;
};

}  // namespace relume::gltf
