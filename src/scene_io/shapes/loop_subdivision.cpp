#include "scene_io/shapes/loop_subdivision.h"

#include <algorithm>
#include <unordered_map>

#include "scene_io/mesh_repair.h"

namespace relume {
namespace {

struct Edge {
  uint32_t a, b;
  Vec3 opposite{0};  ///< sum of the third vertices
  int faces = 0;

  bool is_boundary() const { return faces != 2; }
};

/// Edges of a mesh, in the order of their first triangle.
class Edges {
 public:
  explicit Edges(const Mesh& mesh) {
    of_triangle.reserve(mesh.triangles.size());
    for (const UVec3& t : mesh.triangles) {
      UVec3 edges;
      for (int k = 0; k < 3; ++k) edges[k] = add(t[k], t[(k + 1) % 3], mesh.positions[t[(k + 2) % 3]]);
      of_triangle.push_back(edges);
    }
  }

  std::vector<Edge> all;
  std::vector<UVec3> of_triangle;  ///< edges 01, 12, 20 of each triangle

 private:
  uint32_t add(uint32_t a, uint32_t b, const Vec3& opposite) {
    const uint64_t key = (uint64_t{std::min(a, b)} << 32) | std::max(a, b);
    const auto [entry, is_new] = index_.try_emplace(key, static_cast<uint32_t>(all.size()));
    if (is_new) all.push_back({a, b});
    Edge& edge = all[entry->second];
    edge.opposite += opposite;
    ++edge.faces;
    return entry->second;
  }

  std::unordered_map<uint64_t, uint32_t> index_;
};

/// Sums over the neighbours of each vertex.
struct Ring {
  Vec3 sum{0};
  int count = 0;
  Vec3 boundary_sum{0};
  int boundary_count = 0;
};

std::vector<Ring> rings(const Mesh& mesh, const Edges& edges) {
  std::vector<Ring> result(mesh.positions.size());
  const auto add = [&](uint32_t to, uint32_t from, bool boundary) {
    Ring& ring = result[to];
    ring.sum += mesh.positions[from];
    ++ring.count;
    if (!boundary) return;
    ring.boundary_sum += mesh.positions[from];
    ++ring.boundary_count;
  };
  for (const Edge& edge : edges.all) {
    add(edge.a, edge.b, edge.is_boundary());
    add(edge.b, edge.a, edge.is_boundary());
  }
  return result;
}

/// Warren's weight of each of `valence` neighbours.
float beta(int valence) { return valence == 3 ? 3.0f / 16 : 3.0f / (8 * static_cast<float>(valence)); }

Vec3 weighted(const Vec3& p, const Vec3& sum, int count, float weight) {
  return (1 - static_cast<float>(count) * weight) * p + weight * sum;
}

/// Moves each vertex by its neighbours: `interior(valence)` and `boundary` are the weights of each.
template <typename Weight>
std::vector<Vec3> moved(const Mesh& mesh, const Edges& edges, const Weight& interior, float boundary) {
  const std::vector<Ring> all = rings(mesh, edges);
  std::vector<Vec3> result = mesh.positions;
  for (size_t i = 0; i < result.size(); ++i) {
    const Ring& ring = all[i];
    if (ring.boundary_count == 2) {
      result[i] = weighted(result[i], ring.boundary_sum, 2, boundary);
    } else if (ring.boundary_count == 0 && ring.count > 0) {
      result[i] = weighted(result[i], ring.sum, ring.count, interior(ring.count));
    }
  }
  return result;
}

Mesh refined(const Mesh& mesh) {
  const Edges edges(mesh);
  Mesh result;
  result.positions = moved(mesh, edges, beta, 1.0f / 8);
  const auto first = static_cast<uint32_t>(mesh.positions.size());
  for (const Edge& edge : edges.all) {
    const Vec3 ends = mesh.positions[edge.a] + mesh.positions[edge.b];
    result.positions.push_back(edge.is_boundary() ? ends / 2.0f : ends * (3.0f / 8) + edge.opposite / 8.0f);
  }
  result.triangles.reserve(4 * mesh.triangles.size());
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const UVec3& t = mesh.triangles[i];
    const UVec3 middle = edges.of_triangle[i] + first;
    result.triangles.emplace_back(t[0], middle[0], middle[2]);
    result.triangles.emplace_back(t[1], middle[1], middle[0]);
    result.triangles.emplace_back(t[2], middle[2], middle[1]);
    result.triangles.push_back(middle);
  }
  return result;
}

}  // namespace

Mesh loop_subdivided(std::span<const Vec3> positions, std::span<const UVec3> triangles, int levels) {
  Mesh mesh;
  mesh.positions.assign(positions.begin(), positions.end());
  for (const UVec3& t : triangles) {
    if (t.x != t.y && t.y != t.z && t.z != t.x) mesh.triangles.push_back(t);
  }
  for (int i = 0; i < levels && 4 * mesh.triangles.size() <= kMaxSubdivided; ++i) mesh = refined(mesh);
  const auto limit_weight = [](int valence) { return 1 / (static_cast<float>(valence) + 3 / (8 * beta(valence))); };
  mesh.positions = moved(mesh, Edges(mesh), limit_weight, 1.0f / 6);
  mesh.normals = smooth_normals(mesh);
  return mesh;
}

}  // namespace relume
