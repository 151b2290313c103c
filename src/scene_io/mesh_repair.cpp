#include "scene_io/mesh_repair.h"

#include <algorithm>

#include <fmt/format.h>
#include <glm/common.hpp>

#include "scene/placement.h"

namespace relume {
namespace {

bool usable(const Vec3& p) {
  return std::fabs(p.x) <= kMaxCoordinate && std::fabs(p.y) <= kMaxCoordinate && std::fabs(p.z) <= kMaxCoordinate;
}
bool usable(const Vec2& p) { return std::fabs(p.x) <= kMaxCoordinate && std::fabs(p.y) <= kMaxCoordinate; }
bool usable(const Vec4& p) { return usable(Vec3(p)) && std::fabs(p.w) <= kMaxCoordinate; }

void drop_broken_triangles(Mesh& mesh, Warnings& warnings) {
  const size_t count = mesh.positions.size();
  std::vector<bool> broken(count, false);
  size_t broken_vertices = 0;
  for (size_t i = 0; i < count; ++i) {
    if (usable(mesh.positions[i])) continue;
    mesh.positions[i] = Vec3(0);
    broken[i] = true;
    ++broken_vertices;
  }
  size_t out_of_range = 0;
  const size_t dropped = std::erase_if(mesh.triangles, [&](const UVec3& t) {
    if (t.x >= count || t.y >= count || t.z >= count) {
      ++out_of_range;
      return true;
    }
    return broken_vertices > 0 && (broken[t.x] || broken[t.y] || broken[t.z]);
  });
  if (out_of_range > 0)
    warnings.add(
        fmt::format("mesh '{}': {} triangles with vertex indices out of range are dropped", mesh.name, out_of_range));
  if (broken_vertices > 0)
    warnings.add(
        fmt::format("mesh '{}': {} vertices are not finite or beyond {:g} m; {} triangles that use them are dropped",
                    mesh.name, broken_vertices, kMaxCoordinate, dropped - out_of_range));
}

void repair_normals(Mesh& mesh, Warnings& warnings) {
  std::vector<size_t> broken;
  for (size_t i = 0; i < mesh.normals.size(); ++i) {
    const float length = glm::length(mesh.normals[i]);
    if (length > 0 && is_finite(length)) {
      mesh.normals[i] /= length;
    } else {
      broken.push_back(i);
    }
  }
  if (broken.empty()) return;
  const std::vector<Vec3> computed = smooth_normals(mesh);
  for (const size_t i : broken) mesh.normals[i] = computed[i];
  warnings.add(fmt::format("mesh '{}': {} normals without direction are computed from the adjacent triangles",
                           mesh.name, broken.size()));
}

void repair_tangents(Mesh& mesh, Warnings& warnings) {
  for (Vec4& tangent : mesh.tangents) {
    const float length = glm::length(Vec3(tangent));
    if (!(length > 0 && is_finite(length))) {
      warnings.add(fmt::format(
          "mesh '{}': tangents without direction are ignored; they are derived from texture coordinates", mesh.name));
      mesh.tangents.clear();
      for (MorphTarget& target : mesh.morph_targets) target.tangents.clear();
      return;
    }
    tangent = Vec4(Vec3(tangent) / length, tangent.w < 0 ? -1.0f : 1.0f);
  }
}

template <typename V>
void replace_broken(std::vector<V>& values, const V& by, const char* what, const std::string& mesh,
                    Warnings& warnings) {
  const auto is_broken = [](const V& v) { return !usable(v); };
  const auto broken = std::count_if(values.begin(), values.end(), is_broken);
  if (broken == 0) return;
  std::replace_if(values.begin(), values.end(), is_broken, by);
  warnings.add(fmt::format("mesh '{}': {} {} are not finite or beyond {:g} and are replaced by {:g}", mesh, broken,
                           what, kMaxCoordinate, by.x));
}

/// glTF 2.0, §3.7.2.1: colours are clamped.
void clamp_colors(Mesh& mesh, Warnings& warnings) {
  size_t outside = 0;
  for (Vec4& color : mesh.colors) {
    const Vec4 clamped = glm::clamp(color, Vec4(0), Vec4(1));
    outside += clamped != color;
    color = clamped;
  }
  if (outside > 0)
    warnings.add(fmt::format("mesh '{}': {} vertex colours outside [0, 1] are clamped", mesh.name, outside));
}

/// Removes values of vertices that are not kept; each vertex has `per_vertex` values.
template <typename V>
void keep(std::vector<V>& values, const std::vector<bool>& kept, size_t per_vertex = 1) {
  size_t out = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    if (kept[i / per_vertex]) values[out++] = values[i];
  }
  values.resize(out);
  values.shrink_to_fit();
}

void remove_unused_vertices(Mesh& mesh) {
  const size_t count = mesh.positions.size();
  std::vector<bool> used(count, false);
  for (const UVec3& t : mesh.triangles) used[t.x] = used[t.y] = used[t.z] = true;
  if (static_cast<size_t>(std::count(used.begin(), used.end(), true)) * 2 >= count) return;
  std::vector<uint32_t> new_index(count, 0);
  uint32_t next = 0;
  for (size_t i = 0; i < count; ++i) {
    if (used[i]) new_index[i] = next++;
  }
  for (UVec3& t : mesh.triangles) t = {new_index[t.x], new_index[t.y], new_index[t.z]};
  keep(mesh.positions, used);
  keep(mesh.normals, used);
  keep(mesh.tangents, used);
  keep(mesh.uv0, used);
  keep(mesh.uv1, used);
  keep(mesh.colors, used);
  for (MorphTarget& target : mesh.morph_targets) {
    keep(target.positions, used);
    keep(target.normals, used);
    keep(target.tangents, used);
  }
  if (mesh.influences_per_vertex > 0) keep(mesh.influences, used, static_cast<size_t>(mesh.influences_per_vertex));
}

}  // namespace

std::vector<Vec3> smooth_normals(const Mesh& mesh) {
  std::vector<Vec3> normals(mesh.positions.size(), Vec3(0));
  for (const UVec3& t : mesh.triangles) {
    const Vec3& a = mesh.positions[t.x];
    const Vec3 twice_area = glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
    if (!is_finite(twice_area)) continue;
    for (const uint32_t i : {t.x, t.y, t.z}) normals[i] += twice_area;
  }
  for (Vec3& n : normals) {
    const float length = glm::length(n);
    n = length > 0 && is_finite(length) ? n / length : Vec3(0, 1, 0);
  }
  return normals;
}

void repair_mesh(Mesh& mesh, Warnings& warnings) {
  drop_broken_triangles(mesh, warnings);
  remove_unused_vertices(mesh);
  repair_normals(mesh, warnings);
  repair_tangents(mesh, warnings);
  replace_broken(mesh.uv0, Vec2(0), "texture coordinates", mesh.name, warnings);
  replace_broken(mesh.uv1, Vec2(0), "texture coordinates", mesh.name, warnings);
  replace_broken(mesh.colors, Vec4(1), "vertex colours", mesh.name, warnings);
  clamp_colors(mesh, warnings);
  for (MorphTarget& target : mesh.morph_targets) {
    for (std::vector<Vec3>* displacements : {&target.positions, &target.normals, &target.tangents})
      replace_broken(*displacements, Vec3(0), "displacements of a morph target", mesh.name, warnings);
  }
}

}  // namespace relume
