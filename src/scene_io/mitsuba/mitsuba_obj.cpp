#include <array>
#include <charconv>
#include <map>

#include <fmt/format.h>

#include "relume/error.h"
#include "scene_io/mitsuba/mitsuba_meshes.h"
#include "scene_io/mitsuba/mitsuba_values.h"

namespace relume::mitsuba {
namespace {

/// A corner's indices of position, texture coordinates and normal; −1: none.
using Corner = std::array<int64_t, 3>;

class ObjReader {
 public:
  ObjReader(bool flips_v, const std::string& place) : flips_v_(flips_v), place_(place) {}

  void read(std::string_view text) {
    while (!text.empty()) {
      ++line_;
      const size_t end = std::min(text.find('\n'), text.size());
      read_line(text.substr(0, end));
      text.remove_prefix(std::min(end + 1, text.size()));
    }
  }

  Mesh take() {
    if (mesh_.triangles.empty()) throw Error(fmt::format("{}: the file has no faces; export it again", place_));
    if (!has_all_uv_) mesh_.uv0.clear();
    if (!has_all_normals_) mesh_.normals.clear();
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& problem) const {
    throw Error(fmt::format("{}:{}: {}; export the file again", place_, line_, problem));
  }

  void read_line(std::string_view line) {
    const std::vector<std::string_view> words = split(line);
    if (words.empty()) return;
    if (words[0] == "v") {
      positions_.push_back(numbers<3>(words));
    } else if (words[0] == "vn") {
      normals_.push_back(numbers<3>(words));
    } else if (words[0] == "vt") {
      const std::array<float, 2> uv = numbers<2>(words);
      uv_.push_back({uv[0], flips_v_ ? 1 - uv[1] : uv[1]});
    } else if (words[0] == "f") {
      read_face(words);
    }
  }

  static std::vector<std::string_view> split(std::string_view line) { return words_of(line.substr(0, line.find('#'))); }

  template <size_t N>
  std::array<float, N> numbers(const std::vector<std::string_view>& words) const {
    std::array<float, N> values{};
    for (size_t i = 0; i < N; ++i) {
      const std::optional<double> value = i + 1 < words.size() ? parse_number(words[i + 1]) : std::nullopt;
      if (!value) fail(fmt::format("'{}' needs {} finite numbers", words[0], N));
      values[i] = static_cast<float>(*value);
    }
    return values;
  }

  int64_t index(std::string_view text, size_t count) const {
    if (text.empty()) return -1;
    const std::optional<int64_t> value = parse_integer(text);
    const auto size = static_cast<int64_t>(count);
    if (!value || *value == 0 || *value > size || *value < -size)
      fail(fmt::format("the index '{}' is not in the file", text.substr(0, 40)));
    return *value > 0 ? *value - 1 : size + *value;
  }

  Corner corner(std::string_view word) const {
    std::array<std::string_view, 3> parts;
    for (std::string_view& part : parts) {
      const size_t slash = std::min(word.find('/'), word.size());
      part = word.substr(0, slash);
      word.remove_prefix(std::min(slash + 1, word.size()));
    }
    const Corner c = {index(parts[0], positions_.size()), index(parts[1], uv_.size()),
                      index(parts[2], normals_.size())};
    if (c[0] < 0) fail("a corner of a face has no vertex");
    return c;
  }

  uint32_t vertex(const Corner& corner) {
    const auto [known, is_new] = vertices_.try_emplace(corner, static_cast<uint32_t>(mesh_.positions.size()));
    if (!is_new) return known->second;
    const auto vec3 = [](const std::array<float, 3>& a) { return Vec3(a[0], a[1], a[2]); };
    mesh_.positions.push_back(vec3(positions_[static_cast<size_t>(corner[0])]));
    has_all_uv_ = has_all_uv_ && corner[1] >= 0;
    has_all_normals_ = has_all_normals_ && corner[2] >= 0;
    const std::array<float, 2> uv = corner[1] >= 0 ? uv_[static_cast<size_t>(corner[1])] : std::array<float, 2>{};
    mesh_.uv0.emplace_back(uv[0], uv[1]);
    mesh_.normals.push_back(corner[2] >= 0 ? vec3(normals_[static_cast<size_t>(corner[2])]) : Vec3(0, 0, 1));
    return known->second;
  }

  void read_face(const std::vector<std::string_view>& words) {
    std::vector<uint32_t> corners;
    for (size_t i = 1; i < words.size(); ++i) corners.push_back(vertex(corner(words[i])));
    for (size_t i = 2; i < corners.size(); ++i) mesh_.triangles.emplace_back(corners[0], corners[i - 1], corners[i]);
  }

  bool flips_v_;
  const std::string& place_;
  int64_t line_ = 0;
  std::vector<std::array<float, 3>> positions_, normals_;
  std::vector<std::array<float, 2>> uv_;
  std::map<Corner, uint32_t> vertices_;
  Mesh mesh_;
  bool has_all_uv_ = true;
  bool has_all_normals_ = true;
};

}  // namespace

Mesh read_obj(std::span<const std::byte> file, bool flips_v, const std::string& place) {
  ObjReader reader(flips_v, place);
  reader.read({reinterpret_cast<const char*>(file.data()), file.size()});
  return reader.take();
}

}  // namespace relume::mitsuba
