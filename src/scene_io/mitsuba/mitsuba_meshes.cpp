#include "scene_io/mitsuba/mitsuba_meshes.h"

#include <algorithm>
#include <numeric>
#include <tuple>

#include <glm/common.hpp>

#include "core/vec.h"
#include "scene_io/mesh_repair.h"
#include "scene_io/shapes/flat_shapes.h"
#include "scene_io/shapes/quadrics.h"

namespace relume::mitsuba {
namespace {

/// A face of the cube [-1, 1]³ whose texture coordinates grow along `u` and `v`; it faces v × u.
void add_face(Mesh& mesh, const Vec3& u, const Vec3& v) {
  const Vec3 normal = glm::cross(v, u);
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  for (const Vec2 uv : {Vec2(0, 1), Vec2(1, 1), Vec2(1, 0), Vec2(0, 0)}) {
    mesh.positions.push_back(normal + (2 * uv.x - 1) * u + (2 * uv.y - 1) * v);
    mesh.normals.push_back(normal);
    mesh.uv0.push_back(uv);
  }
  mesh.triangles.emplace_back(first, first + 1, first + 2);
  mesh.triangles.emplace_back(first + 3, first, first + 2);
}

Mesh cube() {
  constexpr Vec3 kX(1, 0, 0), kY(0, 1, 0), kZ(0, 0, 1);
  Mesh mesh;
  add_face(mesh, kZ, kX);
  add_face(mesh, -kX, -kZ);
  add_face(mesh, kY, -kZ);
  add_face(mesh, kY, kX);
  add_face(mesh, kY, kZ);
  add_face(mesh, -kY, kX);
  return mesh;
}

void flip_v(Mesh& mesh) {
  for (Vec2& uv : mesh.uv0) uv.y = 1 - uv.y;
}

/// Edges and derivatives of a triangle's surface by its texture coordinates, times twice the area in these.
struct Derivatives {
  Vec3 du{0};
  Vec3 dv{0};
  Vec3 normal{0};  ///< times twice the area
  float determinant = 0;
};

Derivatives derivatives(const Mesh& mesh, const UVec3& t, const std::vector<Vec3>& positions) {
  const Vec3 e1 = positions[t.y] - positions[t.x];
  const Vec3 e2 = positions[t.z] - positions[t.x];
  const Vec2 d1 = mesh.uv0[t.y] - mesh.uv0[t.x];
  const Vec2 d2 = mesh.uv0[t.z] - mesh.uv0[t.x];
  return {e1 * d2.y - e2 * d1.y, e2 * d1.x - e1 * d2.x, glm::cross(e1, e2), d1.x * d2.y - d1.y * d2.x};
}

}  // namespace

Mesh unit_shape(const std::string& type, int segments) {
  Mesh mesh;
  if (type == "cube") return cube();
  if (type == "sphere") return sphere_mesh({}, segments);
  if (type == "rectangle") {
    mesh = rectangle_mesh();
    flip_v(mesh);
  } else if (type == "disk") {
    mesh = disk_mesh({}, segments);
    for (Vec2& uv : mesh.uv0) uv = Vec2(uv.y, uv.x);
  } else if (type == "cylinder") {
    mesh = cylinder_mesh({.radius = 1, .z_min = 0, .z_max = 1}, segments);
    flip_v(mesh);
  }
  return mesh;
}

void flip(Mesh& mesh) {
  for (UVec3& t : mesh.triangles) std::swap(t.y, t.z);
  for (Vec3& n : mesh.normals) n = -n;
}

void add_smooth_normals(Mesh& mesh) {
  const std::vector<Vec3>& p = mesh.positions;
  std::vector<uint32_t> by_position(p.size());
  std::iota(by_position.begin(), by_position.end(), 0u);
  const auto key = [&](uint32_t i) { return std::tie(p[i].x, p[i].y, p[i].z, i); };
  std::sort(by_position.begin(), by_position.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
  std::vector<uint32_t> shared(p.size());
  for (size_t k = 0; k < by_position.size(); ++k) {
    const uint32_t i = by_position[k];
    shared[i] = k > 0 && p[by_position[k - 1]] == p[i] ? shared[by_position[k - 1]] : i;
  }
  Mesh joined;
  joined.positions = mesh.positions;
  for (const UVec3& t : mesh.triangles) joined.triangles.emplace_back(shared[t.x], shared[t.y], shared[t.z]);
  const std::vector<Vec3> normals = smooth_normals(joined);
  mesh.normals.resize(mesh.positions.size());
  for (size_t i = 0; i < mesh.normals.size(); ++i) mesh.normals[i] = normals[shared[i]];
}

void add_tangents(Mesh& mesh) {
  if (mesh.uv0.empty() || mesh.normals.empty()) return;
  std::vector<Vec3> sums(mesh.positions.size(), Vec3(0));
  for (const UVec3& t : mesh.triangles) {
    const Derivatives d = derivatives(mesh, t, mesh.positions);
    const Vec3 along = d.determinant < 0 ? -d.du : d.du;
    if (!is_finite(along)) continue;
    for (const uint32_t i : {t.x, t.y, t.z}) sums[i] += along;
  }
  mesh.tangents.clear();
  for (size_t i = 0; i < sums.size(); ++i) {
    const Vec3& n = mesh.normals[i];
    Vec3 tangent = sums[i] - n * glm::dot(n, sums[i]);
    if (!(glm::length(tangent) > 0)) tangent = glm::cross(n, std::fabs(n.x) < 0.9f ? Vec3(1, 0, 0) : Vec3(0, 1, 0));
    mesh.tangents.emplace_back(glm::normalize(tangent), 1.0f);
  }
}

Vec2 stretch(const Mesh& mesh, const Mat4& to_world) {
  if (mesh.uv0.empty()) return Vec2(1);
  std::vector<Vec3> positions = mesh.positions;
  for (Vec3& p : positions) p = transform_vector(to_world, p);
  glm::dvec2 sum(0);
  double areas = 0;
  double right_handed = 0;
  for (const UVec3& t : mesh.triangles) {
    const Derivatives d = derivatives(mesh, t, positions);
    const double area = glm::length(d.normal);
    const double determinant = std::fabs(d.determinant);
    if (!(determinant > 0) || !(area > 0) || !is_finite(d.normal)) continue;
    sum += glm::dvec2(glm::length(d.du), glm::length(d.dv)) / determinant * area;
    right_handed += d.determinant > 0 ? area : -area;
    areas += area;
  }
  if (!(areas > 0) || !(sum.x > 0 && sum.y > 0)) return Vec2(1);
  const Vec2 mean = sum / areas;
  return Vec2(mean.x, right_handed < 0 ? -mean.y : mean.y);
}

}  // namespace relume::mitsuba
