#include "scene_io/ply/ply_loader.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "core/srgb.h"
#include "files/bytes.h"
#include "relume/error.h"
#include "scene_io/mesh_repair.h"
#include "scene_io/ply/ply_header.h"

namespace relume {
namespace {

using ply::Encoding;
using ply::Type;

/// Reads the body's numbers in sequence.
class NumberReader {
 public:
  NumberReader(std::string_view body, Encoding encoding, const std::string& place)
      : body_(body), encoding_(encoding), place_(place) {}

  double next(Type type) { return encoding_ == Encoding::ascii ? next_text() : next_binary(type); }
  size_t bytes_left() const { return body_.size(); }

  [[noreturn]] void fail(const std::string& problem) const {
    throw Error(fmt::format("{}: {}; the file is damaged, export or copy it again", place_, problem));
  }

 private:
  double next_text() {
    const size_t start = body_.find_first_not_of(" \t\r\n");
    if (start == std::string_view::npos) fail("it ends too early");
    const size_t end = std::min(body_.find_first_of(" \t\r\n", start), body_.size());
    std::string_view word = body_.substr(start, end - start);
    body_.remove_prefix(end);
    if (word.starts_with('+')) word.remove_prefix(1);
    double value = 0;
    const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || rest != word.data() + word.size())
      fail(fmt::format("'{}' is not a number", word.substr(0, 40)));
    return value;
  }

  template <typename T>
  double take() {
    unsigned char bytes[sizeof(T)];
    std::memcpy(bytes, body_.data(), sizeof(T));
    if ((encoding_ == Encoding::big_endian) == (std::endian::native == std::endian::little))
      std::reverse(bytes, bytes + sizeof(T));
    T value;
    std::memcpy(&value, bytes, sizeof(T));
    body_.remove_prefix(sizeof(T));
    return static_cast<double>(value);
  }

  double next_binary(Type type) {
    if (body_.size() < ply::size_of(type)) fail("it ends too early");
    switch (type) {
      case Type::i8: return take<int8_t>();
      case Type::u8: return take<uint8_t>();
      case Type::i16: return take<int16_t>();
      case Type::u16: return take<uint16_t>();
      case Type::i32: return take<int32_t>();
      case Type::u32: return take<uint32_t>();
      case Type::f32: return take<float>();
      case Type::f64: break;
    }
    return take<double>();
  }

  std::string_view body_;
  Encoding encoding_;
  const std::string& place_;
};

/// Linear value of a colour. Integers are sRGB-encoded, as scanners and editors write them; floats are linear.
float linear_color(Type type, float value) {
  if (type == Type::u8) return linear_from_srgb(value / 255);
  if (type == Type::u16) return linear_from_srgb(value / 65535);
  return value;
}

float alpha_of(Type type, float value) { return value / (type == Type::u8 ? 255 : type == Type::u16 ? 65535 : 1); }

/// Doubles beyond float's range become infinite, for repair_mesh() to handle.
float narrow(double value) { return std::fabs(value) > 3e38 ? kInfinity : static_cast<float>(value); }

void check_count(const NumberReader& reader, const ply::Element& element) {
  // An element takes at least one byte (in ASCII two with its separator, except the last).
  if (element.count > reader.bytes_left() || element.count > 0xffffffffu)
    reader.fail(
        fmt::format("{} elements '{}' do not fit into {} bytes", element.count, element.name, reader.bytes_left()));
}

void skip(NumberReader& reader, const ply::Property& property) {
  const double count = property.is_list ? reader.next(property.count_type) : 1;
  for (double i = 0; i < count; ++i) reader.next(property.type);
}

/// Columns of an attribute's components in a vertex; -1 if missing.
template <size_t N>
struct Columns {
  std::array<int, N> at;

  bool complete() const { return *std::min_element(at.begin(), at.end()) >= 0; }
  float operator()(const std::vector<float>& row, size_t i) const { return row[static_cast<size_t>(at[i])]; }
};

void read_vertices(NumberReader& reader, const ply::Element& element, Mesh& mesh) {
  const Columns<3> position{{element.find({"x"}), element.find({"y"}), element.find({"z"})}};
  const Columns<3> normal{{element.find({"nx"}), element.find({"ny"}), element.find({"nz"})}};
  const Columns<2> uv{{element.find({"u", "s", "texture_u"}), element.find({"v", "t", "texture_v"})}};
  const Columns<3> color{{element.find({"red", "r"}), element.find({"green", "g"}), element.find({"blue", "b"})}};
  const Columns<1> alpha{{element.find({"alpha", "a"})}};
  if (!position.complete()) reader.fail("its vertices have no x, y and z");
  std::vector<float> row(element.properties.size(), 0.0f);
  for (uint64_t i = 0; i < element.count; ++i) {
    for (size_t p = 0; p < row.size(); ++p) {
      if (element.properties[p].is_list) {
        skip(reader, element.properties[p]);
      } else {
        row[p] = narrow(reader.next(element.properties[p].type));
      }
    }
    const auto vec3 = [&](const Columns<3>& c) { return Vec3(c(row, 0), c(row, 1), c(row, 2)); };
    mesh.positions.push_back(vec3(position));
    if (normal.complete()) mesh.normals.push_back(vec3(normal));
    if (uv.complete()) mesh.uv0.emplace_back(uv(row, 0), 1 - uv(row, 1));
    if (!color.complete()) continue;
    const auto type = [&](const auto& c, size_t k) { return element.properties[static_cast<size_t>(c.at[k])].type; };
    const auto linear = [&](size_t k) { return linear_color(type(color, k), color(row, k)); };
    mesh.colors.emplace_back(linear(0), linear(1), linear(2),
                             alpha.complete() ? alpha_of(type(alpha, 0), alpha(row, 0)) : 1.0f);
  }
}

uint32_t to_index(double value) {
  return value >= 0 && value < 4294967295.0 ? static_cast<uint32_t>(value) : 0xffffffffu;
}

void read_faces(NumberReader& reader, const ply::Element& element, Mesh& mesh) {
  const int indices = element.find({"vertex_indices", "vertex_index"});
  for (uint64_t i = 0; i < element.count; ++i) {
    for (size_t p = 0; p < element.properties.size(); ++p) {
      const ply::Property& property = element.properties[p];
      if (static_cast<int>(p) != indices || !property.is_list) {
        skip(reader, property);
        continue;
      }
      const double corners = reader.next(property.count_type);
      UVec3 triangle(0);
      for (double k = 0; k < corners; ++k) {
        const uint32_t index = to_index(reader.next(property.type));
        if (k == 0) triangle.x = index;
        if (k >= 2) mesh.triangles.emplace_back(triangle.x, triangle.z, index);
        triangle.z = index;
      }
    }
  }
}

Scene scene_of(Mesh mesh, Warnings warnings, const std::string& place) {
  Scene scene;
  scene.environment.kind = EnvironmentKind::automatic;
  scene.name = std::filesystem::path(place).stem().string();
  mesh.name = scene.name;
  mesh.material = 0;
  repair_mesh(mesh, warnings);
  if (mesh.triangles.empty())
    throw Error(
        fmt::format("{}: the file has no triangles; point clouds are not supported, convert it to a mesh", place));
  if (mesh.normals.empty()) mesh.normals = smooth_normals(mesh);
  Material material;
  material.name = "default";
  material.base_color = mesh.colors.empty() ? Rgb(0.8f) : Rgb(1);
  material.metallic = 0;
  material.double_sided = true;
  Node node;
  node.name = scene.name;
  node.meshes = {0};
  scene.materials.push_back(std::move(material));
  scene.meshes.push_back(std::move(mesh));
  scene.add_node(std::move(node));
  scene.warnings = warnings.take();
  validate(scene, place);
  return scene;
}

}  // namespace

Mesh read_ply_mesh(std::span<const std::byte> file, const std::string& place, Warnings& warnings) {
  const std::string_view text(reinterpret_cast<const char*>(file.data()), file.size());
  const ply::Header header = ply::parse_header(text, place);
  NumberReader reader(text.substr(header.size), header.encoding, place);
  Mesh mesh;
  for (const ply::Element& element : header.elements) {
    if (element.properties.empty()) continue;
    check_count(reader, element);
    if (element.name == "vertex" && mesh.positions.empty()) {
      read_vertices(reader, element, mesh);
    } else if (element.name == "face" && mesh.triangles.empty()) {
      read_faces(reader, element, mesh);
      if (element.find({"texcoord"}) >= 0)
        warnings.add("texture coordinates of faces are ignored; give them to vertices");
    } else {
      for (uint64_t i = 0; i < element.count; ++i) {
        for (const ply::Property& property : element.properties) skip(reader, property);
      }
      if (element.count > 0) warnings.add(fmt::format("its element '{}' is ignored", element.name));
    }
  }
  const auto is_strip = [](const ply::Element& element) { return element.name == "tristrips"; };
  if (mesh.triangles.empty() && std::any_of(header.elements.begin(), header.elements.end(), is_strip))
    throw Error(fmt::format("{}: triangle strips are not supported; save the mesh with faces", place));
  return mesh;
}

Scene load_ply_from_memory(std::span<const std::byte> file, const std::string& place) {
  Warnings warnings(place);
  Mesh mesh = read_ply_mesh(file, place, warnings);
  return scene_of(std::move(mesh), std::move(warnings), place);
}

Scene load_ply(const std::filesystem::path& file) { return load_ply_from_memory(read_file_bytes(file), file.string()); }

}  // namespace relume
