#include <bit>
#include <cstring>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include "scene_io/pbrt/pbrt_write_scene.h"

namespace relume::pbrt {
namespace {

static_assert(std::endian::native == std::endian::little, "PLY files are written in the processor's byte order");

template <typename T>
void append(std::string& bytes, const T& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// Whole number to add to the texture coordinates so that they lie in [0, 1], where pbrt reads the images of area
/// lights, or std::nullopt if they span more. Other textures repeat and do not change.
std::optional<Vec2> shift_to_unit(const Mesh& m) {
  constexpr float kTolerance = 0.01f;
  if (m.uv0.empty()) return Vec2(0);
  Vec2 low = m.uv0[0], high = m.uv0[0];
  for (const Vec2& uv : m.uv0) {
    low = glm::min(low, uv);
    high = glm::max(high, uv);
  }
  const Vec2 shift = -glm::floor(low + kTolerance);
  if (glm::any(glm::greaterThan(high + shift, Vec2(1 + kTolerance)))) return std::nullopt;
  return shift;
}

/// Binary PLY with v upwards, as pbrt reads it.
std::string ply_of(const Mesh& m, const Vec2& uv_shift) {
  std::string text = "ply\nformat binary_little_endian 1.0\n";
  text += fmt::format("element vertex {}\nproperty float x\nproperty float y\nproperty float z\n", m.positions.size());
  if (!m.normals.empty()) text += "property float nx\nproperty float ny\nproperty float nz\n";
  if (!m.uv0.empty()) text += "property float u\nproperty float v\n";
  text += fmt::format("element face {}\nproperty list uchar int vertex_indices\nend_header\n", m.triangles.size());
  for (size_t i = 0; i < m.positions.size(); ++i) {
    append(text, m.positions[i]);
    if (!m.normals.empty()) append(text, m.normals[i]);
    if (!m.uv0.empty()) append(text, Vec2(m.uv0[i].x + uv_shift.x, 1 - m.uv0[i].y - uv_shift.y));
  }
  for (const UVec3& t : m.triangles) {
    text += '\3';
    append(text, t);
  }
  return text;
}

class ShapeWriter {
 public:
  ShapeWriter(const Scene& scene, const std::vector<WrittenMaterial>& materials, Output& output)
      : scene_(scene), materials_(materials), output_(output), uses_(scene.meshes.size()) {}

  void count(const Node& node) {
    const size_t copies = node.instances.empty() ? 1 : node.instances.size();
    for (const Index mesh : node.meshes) uses_[static_cast<size_t>(mesh)] += copies;
  }

  void write(const Node& node, const Mat4& world) {
    for (const Index mesh : node.meshes) {
      if (scene_.meshes[static_cast<size_t>(mesh)].triangles.empty()) continue;
      if (node.instances.empty()) place(static_cast<size_t>(mesh), world);
      for (const Mat4& instance : node.instances) place(static_cast<size_t>(mesh), world * instance);
    }
  }

 private:
  const WrittenMaterial& material_of(const Mesh& mesh) const {
    return mesh.material == kNone ? materials_.back() : materials_[static_cast<size_t>(mesh.material)];
  }

  void place(size_t index, const Mat4& world) {
    const WrittenMaterial& material = material_of(scene_.meshes[index]);
    const bool is_object = uses_[index] > 1 && material.area_light.empty();
    if (is_object && !objects_.contains(index)) define(index);
    output_.line("AttributeBegin");
    if (world != Mat4(1)) output_.line("  Transform " + numbers(world));
    if (is_object) {
      output_.line("  ObjectInstance " + objects_.at(index));
    } else {
      write_shape(index, material);
    }
    output_.line("AttributeEnd");
  }

  void define(size_t index) {
    const std::string name = in_quotes(fmt::format("{} {}", scene_.meshes[index].name, index));
    output_.line("ObjectBegin " + name);
    write_shape(index, material_of(scene_.meshes[index]));
    output_.line("ObjectEnd");
    objects_[index] = name;
  }

  void write_shape(size_t index, const WrittenMaterial& material) {
    output_.line("  NamedMaterial " + material.name);
    if (!material.medium.empty()) output_.line("  MediumInterface " + material.medium + " \"\"");
    if (!material.area_light.empty()) output_.line("  " + material.area_light);
    output_.line("  Shape \"plymesh\" \"string filename\" " + file_of(index) + material.alpha);
  }

  /// Reference of the mesh's file, which is written on the first call.
  const std::string& file_of(size_t index) {
    const auto [entry, is_new] = files_.try_emplace(index);
    if (!is_new) return entry->second;
    const Mesh& mesh = scene_.meshes[index];
    if (!mesh.colors.empty()) output_.note("vertex colours, which pbrt cannot represent, are left out");
    std::optional<Vec2> shift = Vec2(0);
    if (material_of(mesh).has_emission_map) shift = shift_to_unit(mesh);
    if (!shift) output_.note("textures of emission do not repeat; beyond the image, its edge emits");
    entry->second = output_.add_file(fmt::format("mesh-{}.ply", index), [&](const std::filesystem::path& file) {
      write_file(file, ply_of(mesh, shift.value_or(Vec2(0))));
    });
    return entry->second;
  }

  const Scene& scene_;
  const std::vector<WrittenMaterial>& materials_;
  Output& output_;
  std::vector<size_t> uses_;
  std::map<size_t, std::string> objects_;
  std::map<size_t, std::string> files_;
};

}  // namespace

void write_shapes(const Scene& scene, const std::vector<Mat4>& world, const std::vector<bool>& visible,
                  const std::vector<WrittenMaterial>& materials, Output& output) {
  ShapeWriter writer(scene, materials, output);
  for (size_t i = 0; i < scene.nodes.size(); ++i) {
    if (visible[i]) writer.count(scene.nodes[i]);
  }
  for (size_t i = 0; i < scene.nodes.size(); ++i) {
    if (visible[i]) writer.write(scene.nodes[i], world[i]);
  }
}

}  // namespace relume::pbrt
