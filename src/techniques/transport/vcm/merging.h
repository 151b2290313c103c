// Vertex merging ([Georgiev12], [Hachisuka12]): a camera vertex collects the light vertices within a radius, as photon
// mapping does. Each pair forms a path whose weight accounts for all connections and mergings along it.
#pragma once

#include "core/hash.h"
#include "techniques/transport/bdpt/camera_subpath.h"

namespace relume {

/// Position of a light vertex, and its index.
struct GridVertex {
  Vec3 position;
  uint32_t vertex;
};

struct GridCell {
  int32_t x = 0;
  int32_t y = 0;
  int32_t z = 0;

  RELUME_HD bool operator==(const GridCell& other) const { return x == other.x && y == other.y && z == other.z; }
};

/// Grid of cells twice as wide as the merging radius. The vertices around a point are therefore in eight cells. Cells
/// are hashed to buckets, which several cells may share.
struct MergeGrid {
  Vec3 center{0};
  float inverse_edge = 0;  ///< per metre
  uint32_t buckets = 1;    ///< a power of two

  /// Cell that contains `p`, moved back along each axis by `shift` edges.
  RELUME_HD GridCell cell_at(const Vec3& p, float shift = 0.0f) const {
    const Vec3 at = (p - center) * inverse_edge - Vec3(shift);
    return {coordinate(at.x), coordinate(at.y), coordinate(at.z)};
  }
  RELUME_HD uint32_t bucket_of(const GridCell& cell) const {
    return hash(static_cast<uint32_t>(cell.x), static_cast<uint32_t>(cell.y), static_cast<uint32_t>(cell.z)) &
           (buckets - 1);
  }

 private:
  RELUME_HD static int32_t coordinate(float x) {
    constexpr float kLimit = 0x1p30f;
    return static_cast<int32_t>(clamp(std::floor(x), -kLimit, kLimit));
  }
};

/// Bucket of each slot of the light vertices, as keys of group_by_key(). Slots without a vertex that can merge have the
/// key `grid.buckets`.
struct VertexBuckets {
  View<const PathVertex> vertices;
  View<const uint32_t> counts;  ///< vertices of each light subpath
  uint32_t stride = 1;          ///< slots of a light subpath
  MergeGrid grid;

  RELUME_HD uint32_t operator()(size_t i) const {
    const auto slot = static_cast<uint32_t>(i);
    if (slot % stride >= counts[slot / stride] || !vertices[slot].connectable()) return grid.buckets;
    return grid.bucket_of(grid.cell_at(vertices[slot].position));
  }
};

/// Copies the positions of vertices in the order of their buckets; one call per vertex.
struct SortVerticesKernel {
  View<const PathVertex> vertices;
  View<const uint32_t> order;
  View<GridVertex> sorted;

  RELUME_HD void operator()(uint32_t i, uint32_t /*y*/) const { sorted[i] = {vertices[order[i]].position, order[i]}; }
};

/// Weight of merging the last vertex of a camera subpath with a light vertex. `bsdf`: scattering there towards the
/// light vertex's predecessor. Relative to merging, the cuts beside the vertex have the densities 1 / (→p η) and
/// 1 / (←p η), so the sums of both sides are those of `partial_weights.h` for ←p = 1, divided by η².
RELUME_HD inline float weight_of_merging(const CameraSubpath& e, const BsdfEval& bsdf, const PathVertex& v) {
  const float inverse = 1.0f / e.weights.merging();
  return weight_from(v.weights.sum(1.0f, bsdf.pdf_forward) * inverse,
                     e.weights.at().sum(1.0f, bsdf.pdf_reverse) * inverse);
}

/// Radiance towards the camera subpath, times π r² n, that it receives by merging with the light vertex.
RELUME_HD inline Rgb merged_radiance(const BdptContext& c, const SurfacePoint& sp, const CameraSubpath& e,
                                     const PathVertex& v) {
  const BsdfEval bsdf = eval_camera_vertex(e, sp, v.wo);
  if (is_black(bsdf.f)) return Rgb(0);
  // Light vertices measure the light per area of their surface.
  const float cosines = shading_cosine(sp, v.wo) / glm::dot(v.ng, v.wo);
  Rgb radiance = v.throughput * bsdf.f * (cosines * weight_of_merging(e, bsdf, v));
  if (c.scene().disperses && !e.path.dispersed && v.disperses(sp.wo)) {
    radiance *= wavelength_weight(e.path.wavelength_nm);
  }
  return radiance;
}

/// Vertices on surfaces with normals further apart (as cosine, regardless of the side) do not merge.
inline constexpr float kMinMergingCosine = 0.7f;

/// All light vertices of a frame. Camera vertices merge with those around them, in the order of the grid, and may be
/// connected to random ones: a light vertex cache ([Davidovic14]).
struct LightVertexGrid {
  View<const PathVertex> vertices;
  View<const GridVertex> sorted;  ///< empty: no vertices
  View<const uint32_t> begins;    ///< first element of `sorted` by bucket, then their number
  MergeGrid grid;
  uint32_t stride = 1;       ///< slots of a light subpath
  float radius_squared = 0;  ///< m²; 0: no merging
  float density = 0;         ///< 1 / (π r² n), n: number of light subpaths
  uint32_t connections = 0;  ///< random connections per camera vertex
  float scale = 0;           ///< of a connection: mean number of vertices of a light subpath over `connections`

  /// Adds the light of both to the camera subpath. `ray_id`: identity of the random choices at its last vertex.
  RELUME_HD void add(const BdptContext& c, const SurfacePoint& sp, uint32_t ray_id, CameraSubpath& e,
                     ConnectionRoulette& roulette, BdptCounters& counters) const {
    if (sorted.empty()) return;
    for (uint32_t i = 0; i < connections; ++i) connect(i, c, sp, ray_id, e, roulette, counters);
    if (radius_squared > 0.0f) merge(c, sp, e);
  }

 private:
  /// Connects to a random vertex, number `i` at this camera vertex.
  RELUME_HD void connect(uint32_t i, const BdptContext& c, const SurfacePoint& sp, uint32_t ray_id, CameraSubpath& e,
                         ConnectionRoulette& roulette, BdptCounters& counters) const {
    constexpr uint32_t kSalt = 0x5c000000u;  // connections to one light subpath have small numbers
    const uint32_t id = hash(ray_id, kSalt + i);
    const uint32_t vertex = sorted[static_cast<uint32_t>(uint64_t{hash(id)} * sorted.size >> 32)].vertex;
    if (e.count() + vertex % stride + 2 > c.max_bidirectional_vertices()) return;
    Connection connection = connect_to_vertex(c, sp, e, vertices[vertex]);
    connection.contribution *= scale;
    try_connection(c, connection, id, e, roulette, counters);
  }

  RELUME_HD void merge(const BdptContext& c, const SurfacePoint& sp, CameraSubpath& e) const {
    const uint32_t longest = c.max_bidirectional_vertices();
    if (e.count() >= longest) return;
    const GridCell first = grid.cell_at(sp.position, 0.5f);
    Rgb sum(0);
    for (int32_t i = 0; i < 8; ++i) {
      const GridCell cell{first.x + (i & 1), first.y + ((i >> 1) & 1), first.z + (i >> 2)};
      sum += sum_over(cell, c, sp, e, longest - e.count());
    }
    e.path.radiance += e.path.throughput * sum * density;
  }

  /// `most`: number of vertices of a light subpath, from its start, with which paths are short enough.
  RELUME_HD Rgb sum_over(const GridCell& cell, const BdptContext& c, const SurfacePoint& sp, const CameraSubpath& e,
                         uint32_t most) const {
    const uint32_t bucket = grid.bucket_of(cell);
    Rgb sum(0);
    for (uint32_t i = begins[bucket]; i < begins[bucket + 1]; ++i) {
      const GridVertex& near = sorted[i];
      if (length_squared(near.position - sp.position) >= radius_squared) continue;
      if (near.vertex % stride >= most || !(grid.cell_at(near.position) == cell)) continue;
      const PathVertex& v = vertices[near.vertex];
      if (std::fabs(glm::dot(v.ng, sp.ng)) < kMinMergingCosine) continue;
      sum += merged_radiance(c, sp, e, v);
    }
    return sum;
  }
};

}  // namespace relume
