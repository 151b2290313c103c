#include "builtin_scenes/shapes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <glm/gtc/matrix_transform.hpp>

namespace relume {
namespace {

/// Keeps axes at exactly length 1, unlike glm::normalize, which multiplies by a rounded reciprocal.
template <typename Vector>
Vector unit(const Vector& v) {
  return v / std::sqrt(glm::dot(v, v));
}

uint32_t vertex_count(const Mesh& mesh) { return static_cast<uint32_t>(mesh.positions.size()); }

void add_vertex(Mesh& mesh, const Vec3& position, const Vec3& normal, const Vec2& uv) {
  mesh.positions.push_back(position);
  mesh.normals.push_back(normal);
  mesh.uv0.push_back(uv);
}

/// Adds two triangles per cell of a row-major grid of vertices: `across` cells per row, `rows` rows, from vertex
/// `first` on. The front faces ∂column × ∂row.
void add_grid_triangles(Mesh& mesh, uint32_t first, int across, int rows) {
  const uint32_t stride = static_cast<uint32_t>(across) + 1;
  for (uint32_t r = 0; r < static_cast<uint32_t>(rows); ++r) {
    for (uint32_t c = 0; c < static_cast<uint32_t>(across); ++c) {
      const uint32_t a = first + r * stride + c;
      mesh.triangles.emplace_back(a, a + 1, a + stride + 1);
      mesh.triangles.emplace_back(a, a + stride + 1, a + stride);
    }
  }
}

void reserve_grid(Mesh& mesh, int across, int rows) {
  const size_t vertices = static_cast<size_t>(across + 1) * static_cast<size_t>(rows + 1);
  mesh.positions.reserve(vertices);
  mesh.normals.reserve(vertices);
  mesh.uv0.reserve(vertices);
  mesh.triangles.reserve(2 * static_cast<size_t>(across) * static_cast<size_t>(rows));
}

Vec3 around_y(float radius, float y, float turn) {
  const float angle = 2 * kPi * turn;
  return {radius * std::cos(angle), y, -radius * std::sin(angle)};
}

/// Adds a disc at height `y` as a fan about its centre, facing up or down.
void add_cap(Mesh& mesh, float radius, float y, int segments, bool up) {
  const Vec3 normal(0, up ? 1 : -1, 0);
  const uint32_t centre = vertex_count(mesh);
  add_vertex(mesh, {0, y, 0}, normal, {0.5f, 0.5f});
  for (int i = 0; i < segments; ++i) {
    const Vec3 p = around_y(radius, y, static_cast<float>(i) / static_cast<float>(segments));
    add_vertex(mesh, p, normal, Vec2(0.5f) + Vec2(p.x, p.z) / (2 * radius));
  }
  for (uint32_t i = 0; i < static_cast<uint32_t>(segments); ++i) {
    const uint32_t a = centre + 1 + i;
    const uint32_t b = centre + 1 + (i + 1) % static_cast<uint32_t>(segments);
    mesh.triangles.push_back(up ? UVec3(centre, a, b) : UVec3(centre, b, a));
  }
}

}  // namespace

Mesh quad(const Vec3& corner, const Vec3& u, const Vec3& v) {
  Mesh mesh;
  const Vec3 normal = unit(glm::cross(u, v));
  add_vertex(mesh, corner, normal, {0, 1});
  add_vertex(mesh, corner + u, normal, {1, 1});
  add_vertex(mesh, corner + u + v, normal, {1, 0});
  add_vertex(mesh, corner + v, normal, {0, 0});
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

Mesh box(const Vec3& low, const Vec3& high) {
  const Vec3 size = high - low;
  const Vec3 x(size.x, 0, 0);
  const Vec3 y(0, size.y, 0);
  const Vec3 z(0, 0, size.z);
  Mesh mesh = quad(low + z, x, y);         // +Z
  append(mesh, quad(low + x, -x, y));      // -Z
  append(mesh, quad(low + x + z, -z, y));  // +X
  append(mesh, quad(low, z, y));           // -X
  append(mesh, quad(low + y + z, x, -z));  // +Y
  append(mesh, quad(low, x, z));           // -Y
  return mesh;
}

Mesh icosphere(float radius, int levels) {
  const float g = (1 + std::sqrt(5.0f)) / 2;
  Mesh mesh;
  mesh.positions = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                    {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                    {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                    {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (Vec3& p : mesh.positions) p = unit(p);
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
    const auto middle = [&](uint32_t a, uint32_t b) {
      const auto [entry, is_new] = middles.try_emplace(std::minmax(a, b), vertex_count(mesh));
      if (is_new) mesh.positions.push_back(unit(mesh.positions[a] + mesh.positions[b]));
      return entry->second;
    };
    std::vector<UVec3> finer;
    finer.reserve(4 * mesh.triangles.size());
    for (const UVec3& t : mesh.triangles) {
      const uint32_t xy = middle(t.x, t.y);
      const uint32_t yz = middle(t.y, t.z);
      const uint32_t zx = middle(t.z, t.x);
      finer.insert(finer.end(), {{t.x, xy, zx}, {xy, t.y, yz}, {zx, yz, t.z}, {xy, yz, zx}});
    }
    mesh.triangles = std::move(finer);
  }
  mesh.normals = mesh.positions;
  for (Vec3& p : mesh.positions) {
    mesh.uv0.emplace_back(0.5f + std::atan2(p.x, p.z) / (2 * kPi), std::acos(clamp(p.y, -1, 1)) / kPi);
    p *= radius;
  }
  return mesh;
}

Mesh disc(float radius, int segments) {
  Mesh mesh;
  add_cap(mesh, radius, 0, segments, true);
  return mesh;
}

Mesh cylinder(float radius, float height, int segments, bool capped) {
  Mesh mesh = lathe({{radius, 0}, {radius, height}}, segments);
  if (capped) {
    add_cap(mesh, radius, height, segments, true);
    add_cap(mesh, radius, 0, segments, false);
  }
  return mesh;
}

Mesh lathe(const std::vector<Vec2>& profile, int segments) {
  const size_t pieces = profile.size() - 1;
  std::vector<Vec2> outward(pieces);  // per piece of the profile
  for (size_t i = 0; i < pieces; ++i) {
    const Vec2 along = unit(profile[i + 1] - profile[i]);
    outward[i] = {along.y, -along.x};
  }
  const float smooth_cosine = std::cos(40 * kPi / 180);
  const auto end_normal = [&](size_t piece, bool last) {
    const size_t other = last ? piece + 1 : piece - 1;
    const bool smooth = other < pieces && glm::dot(outward[piece], outward[other]) > smooth_cosine;
    return smooth ? unit(outward[piece] + outward[other]) : outward[piece];
  };
  Mesh mesh;
  for (size_t i = 0; i < pieces; ++i) {
    const uint32_t first = vertex_count(mesh);
    for (const bool last : {false, true}) {
      const Vec2 p = profile[i + (last ? 1 : 0)];
      const Vec2 n = end_normal(i, last);
      const float v = static_cast<float>(i + (last ? 1 : 0)) / static_cast<float>(pieces);
      for (int s = 0; s <= segments; ++s) {
        const float u = static_cast<float>(s) / static_cast<float>(segments);
        const float turn = s == segments ? 0.0f : u;
        add_vertex(mesh, around_y(p.x, p.y, turn), unit(around_y(n.x, n.y, turn)), {u, 1 - v});
      }
    }
    add_grid_triangles(mesh, first, segments, 1);
  }
  remove_degenerate(mesh);
  return mesh;
}

Mesh height_field(const Vec2& low, const Vec2& high, int cells_x, int cells_z,
                  const std::function<float(float, float)>& height) {
  return parametric_surface(cells_z, cells_x, [&](float u, float v) {
    const float x = lerp(low.x, high.x, v);
    const float z = lerp(low.y, high.y, u);
    return Vec3(x, height(x, z), z);
  });
}

Mesh parametric_surface(int count_u, int count_v, const std::function<Vec3(float, float)>& position) {
  Mesh mesh;
  reserve_grid(mesh, count_u, count_v);
  for (int j = 0; j <= count_v; ++j) {
    const float v = static_cast<float>(j) / static_cast<float>(count_v);
    for (int i = 0; i <= count_u; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(count_u);
      add_vertex(mesh, position(u, v), Vec3(0), {u, v});
    }
  }
  add_grid_triangles(mesh, 0, count_u, count_v);
  smooth_normals(mesh);

  const auto join = [&](size_t a, size_t b) {
    if (glm::distance(mesh.positions[a], mesh.positions[b]) > 1e-4f) return;
    mesh.positions[b] = mesh.positions[a];
    mesh.normals[a] = mesh.normals[b] = unit(mesh.normals[a] + mesh.normals[b]);
  };
  const size_t stride = static_cast<size_t>(count_u) + 1;
  const size_t rows = static_cast<size_t>(count_v) + 1;
  for (size_t j = 0; j < rows; ++j) join(j * stride, j * stride + stride - 1);
  for (size_t i = 0; i < stride; ++i) join(i, (rows - 1) * stride + i);
  return mesh;
}

Mesh torus_knot(int p, int q, float radius, float tube_radius, int count_along, int count_around) {
  const auto centre = [&](float t) {
    const float angle = 2 * kPi * t;
    const float ring = radius * (1 + 0.5f * std::cos(static_cast<float>(q) * angle));
    return Vec3(ring * std::cos(static_cast<float>(p) * angle), 0.5f * radius * std::sin(static_cast<float>(q) * angle),
                ring * std::sin(static_cast<float>(p) * angle));
  };
  Mesh mesh;
  reserve_grid(mesh, count_around, count_along);
  for (int j = 0; j <= count_along; ++j) {
    const float t = j == count_along ? 0.0f : static_cast<float>(j) / static_cast<float>(count_along);
    const Vec3 c = centre(t);
    const Vec3 tangent = unit(centre(t + 1e-3f) - centre(t - 1e-3f));
    // The direction away from the torus' axis rotates with the knot, so the tube closes without a twist.
    const Vec3 a = unit(glm::cross(tangent, Vec3(c.x, 0, c.z)));
    const Vec3 b = glm::cross(a, tangent);
    for (int i = 0; i <= count_around; ++i) {
      const float u = static_cast<float>(i) / static_cast<float>(count_around);
      const float angle = i == count_around ? 0.0f : 2 * kPi * u;
      const Vec3 n = unit(std::cos(angle) * b + std::sin(angle) * a);
      add_vertex(mesh, c + tube_radius * n, n, {u, static_cast<float>(j) / static_cast<float>(count_along)});
    }
  }
  add_grid_triangles(mesh, 0, count_around, count_along);
  return mesh;
}

void append(Mesh& mesh, const Mesh& part) {
  const uint32_t offset = vertex_count(mesh);
  mesh.positions.insert(mesh.positions.end(), part.positions.begin(), part.positions.end());
  mesh.normals.insert(mesh.normals.end(), part.normals.begin(), part.normals.end());
  mesh.uv0.insert(mesh.uv0.end(), part.uv0.begin(), part.uv0.end());
  for (const UVec3& t : part.triangles) mesh.triangles.push_back(t + offset);
}

Mesh transformed(Mesh mesh, const Mat4& matrix) {
  const Mat3 normal_matrix = glm::transpose(glm::inverse(Mat3(matrix)));
  for (Vec3& p : mesh.positions) p = transform_point(matrix, p);
  for (Vec3& n : mesh.normals) n = unit(normal_matrix * n);
  if (glm::determinant(Mat3(matrix)) < 0) {
    for (UVec3& t : mesh.triangles) std::swap(t.y, t.z);
  }
  return mesh;
}

Mesh flipped(Mesh mesh) {
  for (Vec3& n : mesh.normals) n = -n;
  for (UVec3& t : mesh.triangles) std::swap(t.y, t.z);
  return mesh;
}

Mesh flat_shaded(Mesh mesh) {
  mesh.normals.clear();
  return mesh;
}

void remove_degenerate(Mesh& mesh) {
  std::erase_if(mesh.triangles, [&](const UVec3& t) {
    const Vec3& a = mesh.positions[t.x];
    const Vec3& b = mesh.positions[t.y];
    const Vec3& c = mesh.positions[t.z];
    return a == b || b == c || c == a;
  });
}

void smooth_normals(Mesh& mesh) {
  mesh.normals.assign(mesh.positions.size(), Vec3(0));
  for (const UVec3& t : mesh.triangles) {
    const Vec3& a = mesh.positions[t.x];
    const Vec3 twice_area = glm::cross(mesh.positions[t.y] - a, mesh.positions[t.z] - a);
    mesh.normals[t.x] += twice_area;
    mesh.normals[t.y] += twice_area;
    mesh.normals[t.z] += twice_area;
  }
  for (Vec3& n : mesh.normals) {
    const float length = glm::length(n);
    n = length > 0 ? n / length : Vec3(0, 1, 0);  // a vertex of degenerate triangles only
  }
}

Mat4 translation(const Vec3& offset) { return glm::translate(Mat4(1), offset); }
Mat4 rotation_y(float degrees) { return rotation(degrees, Vec3(0, 1, 0)); }
Mat4 rotation(float degrees, const Vec3& axis) { return glm::rotate(Mat4(1), glm::radians(degrees), axis); }
Mat4 scaling(const Vec3& factors) { return glm::scale(Mat4(1), factors); }

}  // namespace relume
