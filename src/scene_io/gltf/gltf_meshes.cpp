#include "scene_io/gltf/gltf_meshes.h"

#include <algorithm>
#include <exception>

#include <fmt/format.h>

#include "core/parallel.h"
#include "scene_io/gltf/gltf_skins.h"
#include "scene_io/gltf/gltf_variants.h"
#include "scene_io/mesh_repair.h"

namespace relume::gltf {
namespace {

/// Limit on the vertices read by all primitives together: many primitives may share a large accessor, which would take
/// hours to read.
constexpr size_t kMaxVerticesRead = size_t{1} << 32;

/// Limit on the bytes of all morph targets and joints, which a small file may also share.
constexpr size_t kMaxDeformationBytes = size_t{8} << 30;

/// Whether attribute `name` exists and fits the other attributes.
bool usable(const PrimitiveReader& reader, const std::string& name, size_t vertex_count, int low, int high,
            const std::string& mesh, Warnings& warnings) {
  const int components = reader.components(name);
  if (components == 0) return false;
  if (components >= low && components <= high && reader.count(name) == vertex_count) return true;
  warnings.add(
      fmt::format("mesh '{}': attribute {} ({} elements of {} components) does not fit its {} vertices and is ignored",
                  mesh, name, reader.count(name), components, vertex_count));
  return false;
}

std::vector<Vec4> read_colors(const PrimitiveReader& reader) {
  if (reader.components("COLOR_0") == 4) return reader.vec4("COLOR_0");
  std::vector<Vec4> colors;
  for (const Vec3& rgb : reader.vec3("COLOR_0")) colors.emplace_back(rgb, 1.0f);
  return colors;
}

size_t displacement_arrays(const tinygltf::Primitive& primitive) {
  size_t count = 0;
  for (const auto& target : primitive.targets) count += target.size();
  return count;
}

bool is_surface(const tinygltf::Primitive& primitive) {
  return primitive.mode == TINYGLTF_MODE_TRIANGLES || primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP ||
         primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN;
}

}  // namespace

std::vector<UVec3> assemble_triangles(const std::vector<uint32_t>& indices, int mode) {
  std::vector<UVec3> triangles;
  if (indices.size() < 3) return triangles;
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    triangles.reserve(indices.size() / 3);
    for (size_t i = 0; i + 2 < indices.size(); i += 3)
      triangles.emplace_back(indices[i], indices[i + 1], indices[i + 2]);
    return triangles;
  }
  triangles.reserve(indices.size() - 2);
  for (size_t i = 0; i + 2 < indices.size(); ++i) {
    if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
      triangles.emplace_back(indices[i + 1], indices[i + 2], indices[0]);
    } else {
      // glTF 2.0, §3.7.2.1: every second triangle of a strip swaps two vertices to keep its orientation.
      triangles.emplace_back(indices[i], indices[i + 1 + i % 2], indices[i + 2 - i % 2]);
    }
  }
  return triangles;
}

void MeshImporter::count_vertices(size_t count) {
  if (vertices_read_ += count; vertices_read_ > kMaxVerticesRead)
    document_.fail(fmt::format("its primitives read more than {} vertices; simplify the meshes or split the file",
                               kMaxVerticesRead));
}

void MeshImporter::count_deformation(size_t bytes) {
  if (deformation_bytes_ += bytes; deformation_bytes_ > kMaxDeformationBytes)
    document_.fail(
        fmt::format("its morph targets and joints take more than {} GiB; simplify the meshes or split the file",
                    kMaxDeformationBytes >> 30));
}

/// Reads vertices and triangles of `mesh`, whose name and material are set. Keeps no triangles if the primitive has
/// none.
void MeshImporter::convert(const tinygltf::Primitive& primitive, Mesh& mesh, Warnings& warnings) {
  const PrimitiveReader reader(document_, primitive);
  const size_t count = reader.count("POSITION");
  if (count == 0) return warnings.add(fmt::format("mesh '{}': a primitive without positions is skipped", mesh.name));
  count_vertices(count);
  count_deformation(count * (sizeof(Vec3) * displacement_arrays(primitive) +
                             joint_sets(reader) * (2 * sizeof(Vec4) + 4 * sizeof(JointInfluence))));
  const auto has = [&](const char* attribute, int low, int high) {
    return usable(reader, attribute, count, low, high, mesh.name, warnings);
  };
  mesh.positions = reader.vec3("POSITION");
  if (has("NORMAL", 3, 3)) mesh.normals = reader.vec3("NORMAL");
  if (!mesh.normals.empty() && has("TANGENT", 4, 4)) mesh.tangents = reader.vec4("TANGENT");
  if (has("TEXCOORD_0", 2, 2)) mesh.uv0 = reader.vec2("TEXCOORD_0");
  if (has("TEXCOORD_1", 2, 2)) mesh.uv1 = reader.vec2("TEXCOORD_1");
  if (has("COLOR_0", 3, 4)) mesh.colors = read_colors(reader);
  read_influences(reader, mesh, warnings);
  read_morph_targets(document_, primitive, mesh, warnings);
  // Draco yields separate triangles for every mode.
  mesh.triangles = assemble_triangles(reader.indices(count),
                                      is_draco_primitive(primitive) ? TINYGLTF_MODE_TRIANGLES : primitive.mode);
  repair_mesh(mesh, warnings);
  if (mesh.triangles.empty())
    warnings.add(fmt::format("mesh '{}': a primitive without triangles is skipped", mesh.name));
}

const std::vector<Index>& MeshImporter::import(int mesh) {
  const auto [entry, is_new] = known_.try_emplace(mesh);
  if (!is_new) return entry->second;
  if (mesh < 0 || static_cast<size_t>(mesh) >= document_.model.meshes.size())
    document_.fail(fmt::format("a node refers to mesh {}, which does not exist; the file is damaged", mesh));
  const tinygltf::Mesh& source = document_.model.meshes[static_cast<size_t>(mesh)];
  const std::string name = source.name.empty() ? fmt::format("mesh {}", mesh) : source.name;
  for (const tinygltf::Primitive& primitive : source.primitives) {
    if (!is_surface(primitive)) {
      ++skipped_primitives_;
      continue;
    }
    entry->second.push_back(static_cast<Index>(scene_.meshes.size()));
    Mesh& target = scene_.meshes.emplace_back();
    target.name = name;
    target.material = materials_.import(primitive.material);
    target.variants = import_variants(document_, primitive, name, scene_.variants.size(), materials_);
    requests_.push_back(&primitive);
  }
  return entry->second;
}

void MeshImporter::finish() {
  std::vector<Warnings> warnings(requests_.size(), Warnings(""));
  std::vector<std::exception_ptr> problems(requests_.size());
  parallel_for(requests_.size(), [&](size_t i) {
    try {
      convert(*requests_[i], scene_.meshes[i], warnings[i]);
    } catch (...) {
      problems[i] = std::current_exception();
    }
  });
  // Rethrows the first problem, so that errors are deterministic.
  for (const std::exception_ptr& problem : problems) {
    if (problem) std::rethrow_exception(problem);
  }
  for (const Warnings& part : warnings) document_.warnings.add(part);
  if (skipped_primitives_ > 0)
    document_.warnings.add(fmt::format("points and lines are skipped ({} primitives)", skipped_primitives_));
  warn_of_lost_anisotropy();
  name_morph_targets();
  leave_out_empty_meshes();
}

void MeshImporter::warn_of_lost_anisotropy() {
  for (const Mesh& mesh : scene_.meshes) {
    if (mesh.material == kNone || !mesh.tangents.empty()) continue;
    const Material& m = scene_.materials[static_cast<size_t>(mesh.material)];
    const TextureRef& coordinates = m.normal_texture.used() ? m.normal_texture : m.anisotropy_texture;
    if (!(m.anisotropy > 0.0f) || !(coordinates.uv_set == 0 ? mesh.uv0 : mesh.uv1).empty()) continue;
    document_.warnings.add(
        fmt::format("mesh '{}' has an anisotropic material but neither tangents nor texture coordinates {}; it is "
                    "rendered without anisotropy, export one of them",
                    mesh.name, coordinates.uv_set));
  }
}

void MeshImporter::name_morph_targets() {
  for (const auto& [index, meshes] : known_) {
    const std::vector<std::string> names = morph_target_names(document_.model.meshes[static_cast<size_t>(index)]);
    for (const Index mesh : meshes) {
      std::vector<MorphTarget>& targets = scene_.meshes[static_cast<size_t>(mesh)].morph_targets;
      for (size_t k = 0; k < std::min(names.size(), targets.size()); ++k) targets[k].name = names[k];
    }
  }
}

void MeshImporter::leave_out_empty_meshes() {
  std::vector<Index> place;  // kNone: removed
  Index kept = 0;
  for (const Mesh& mesh : scene_.meshes) place.push_back(mesh.triangles.empty() ? kNone : kept++);
  std::erase_if(scene_.meshes, [](const Mesh& mesh) { return mesh.triangles.empty(); });
  for (Node& node : scene_.nodes) {
    for (Index& mesh : node.meshes) mesh = place[static_cast<size_t>(mesh)];
    std::erase(node.meshes, kNone);
  }
}

}  // namespace relume::gltf
