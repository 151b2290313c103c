// Vertex merging ([Georgiev12], [Hachisuka12]): a camera vertex collects the light vertices within a radius, as photon
// mapping does. Each pair forms a path whose weight accounts for all connections and mergings along it.
#pragma once

#include "core/hash.h"
#include "techniques/transport/bdpt/camera_subpath.h"

namespace relume {

/// Position of a light vertex, and its index.
struct SortedVertex {
  Vec3 position;
  uint32_t vertex;
};

struct GridCell {
  int32_t x = 0;
  int32_t y = 0;
  int32_t z = 0;
};

/// Grid of cells twice as wide as the merging radius. The vertices around a point are therefore in eight cells. Cells
/// are hashed to buckets, which several cells may share. Neighbours along x have successive buckets, so four ranges of
/// buckets contain the eight cells.
struct MergeGrid {
  Vec3 center{0};
  float inverse_edge = 0;  ///< per metre
  uint32_t buckets = 2;    ///< a power of two, at least 2

  /// Cell that contains `p`, moved back along each axis by `shift` edges.
  RELUME_HD GridCell cell_at(const Vec3& p, float shift = 0.0f) const {
    const Vec3 at = (p - center) * inverse_edge - Vec3(shift);
    return {coordinate(at.x), coordinate(at.y), coordinate(at.z)};
  }
  RELUME_HD uint32_t bucket_of(const GridCell& cell) const {
    const uint32_t row = hash(static_cast<uint32_t>(cell.y), static_cast<uint32_t>(cell.z));
    return (row + static_cast<uint32_t>(cell.x)) & (buckets - 1);
  }
  /// Bucket of a vertex; `buckets` for those that cannot merge.
  RELUME_HD uint32_t key_of(const PathVertex& v) const {
    return v.connectable() ? bucket_of(cell_at(v.position)) : buckets;
  }

 private:
  RELUME_HD static int32_t coordinate(float x) {
    constexpr float kLimit = 0x1p30f;
    return static_cast<int32_t>(clamp(std::floor(x), -kLimit, kLimit));
  }
};

/// Vertices in the order of their buckets.
struct SortedVertices {
  View<const SortedVertex> sorted;
  View<const uint32_t> begins;  ///< first element of `sorted` by bucket, then their number
  MergeGrid grid;
  float radius_squared = 0;  ///< m²

  /// Calls visit(vertex) for the index of each vertex around `p`, in an order that only depends on the arguments.
  template <typename Visit>
  RELUME_HD void for_each_near(const Vec3& p, const Visit& visit) const {
    const GridCell first = grid.cell_at(p, 0.5f);
    // Reads the ranges of all rows before the vertices: their latencies overlap.
    uint32_t begin[4];
    uint32_t end[4];
    for (int32_t row = 0; row < 4; ++row) {
      const uint32_t bucket = grid.bucket_of({first.x, first.y + (row & 1), first.z + (row >> 1)});
      begin[row] = begins[bucket];
      // The last bucket continues at the first.
      end[row] = bucket + 2 <= grid.buckets ? begins[bucket + 2] : sorted.size + begins[1];
    }
    for (int32_t row = 0; row < 4; ++row) {
      for (uint32_t i = begin[row]; i < end[row]; ++i) {
        const SortedVertex& near = sorted[i < sorted.size ? i : i - sorted.size];
        if (length_squared(near.position - p) >= radius_squared) continue;
        // Other cells may share the buckets.
        const GridCell cell = grid.cell_at(near.position);
        const bool in_row = cell.y == first.y + (row & 1) && cell.z == first.z + (row >> 1);
        if (in_row && (cell.x == first.x || cell.x == first.x + 1)) visit(near.vertex);
      }
    }
  }
};

/// Copies the positions of vertices in the order of their buckets; one call per vertex.
struct SortVerticesKernel {
  View<const PathVertex> vertices;
  View<const uint32_t> order;
  View<SortedVertex> sorted;

  RELUME_HD void operator()(uint32_t i, uint32_t /*y*/) const { sorted[i] = {vertices[order[i]].position, order[i]}; }
};

/// Weight of merging the last vertex of a camera subpath with a light vertex. `bsdf`: scattering there towards the
/// light vertex's predecessor. Relative to merging, the cuts beside the vertex have the densities 1 / (→p η) and
/// 1 / (←p η), so the sums of both sides are those of `partial_weights.h` for ←p = 1, divided by η².
/// `recorder`: gets the terms of the weight.
template <typename Recorder = NoRecorder>
RELUME_HD inline float weight_of_merging(const CameraSubpath& e, const BsdfEval& bsdf, const PathVertex& v,
                                         Recorder&& recorder = Recorder{}) {
  const float inverse = 1.0f / e.weights.merging();
  const float cuts_at_light = v.weights.sum(1.0f, bsdf.pdf_forward) * inverse;
  recorder.weigh(weight_terms(cuts_at_light, 1.0f, bsdf.pdf_reverse, 0.0f, inverse));
  return weight_from(cuts_at_light, e.weights.at().sum(1.0f, bsdf.pdf_reverse) * inverse);
}

/// Radiance towards the camera subpath, times π r² n, that it receives by merging with the light vertex.
template <typename Context, typename Recorder>
RELUME_HD inline Rgb merged_radiance(const Context& c, const SurfacePoint& sp, const CameraSubpath& e,
                                     const PathVertex& v, Recorder& recorder) {
  const BsdfEval bsdf = eval_camera_vertex(c, e, sp, v.wo);
  if (is_black(bsdf.f)) return Rgb(0);
  // Light vertices measure the light per area of their surface.
  const float cosines = shading_cosine(sp, v.wo) / glm::dot(v.ng, v.wo);
  Rgb radiance = v.throughput * bsdf.f * (cosines * weight_of_merging(e, bsdf, v, recorder));
  if (c.scene().disperses && !e.path.dispersed && v.disperses(sp.wo)) {
    radiance *= wavelength_weight(e.path.wavelength_nm);
  }
  return radiance;
}

/// Vertices on surfaces with normals further apart (as cosine, regardless of the side) do not merge.
inline constexpr float kMinMergingCosine = 0.7f;

/// Whether the light vertex was found by specular scattering at its predecessor: the cut between them cannot be a
/// connection, so A is zero (partial_weights.h). `number`: of the vertex in its subpath; 0 is the first behind the
/// light. Elsewhere, A is the inverse square of a density per area, and rounds to zero only above 10¹⁹ m⁻²: even for
/// the narrowest lobe (kMinAlpha), only vertices less than a micrometre apart can be mistaken for specular ones.
RELUME_HD inline bool found_specularly(const PathVertex& v, uint32_t number) {
  return number > 0 && !(v.weights.a > 0.0f);
}

/// Merged light of a caustic layer.
struct CausticSum {
  Rgb light{0};
  Rgb difference{0};  ///< with the signs of has_negative_sign()

  RELUME_HD void add(const Rgb& merged, uint32_t path) {
    light += merged;
    difference += has_negative_sign(path) ? -merged : merged;
  }
};

/// All light vertices of a frame. Camera vertices merge with those around them, in the order of the grid, and may be
/// connected to random ones: a light vertex cache ([Davidovic14]).
struct LightVertexGrid {
  View<const PathVertex> vertices;
  View<const GuidedPoint> guides;  ///< of the vertices; empty: camera subpaths are not guided
  SortedVertices near;             ///< empty: no vertices; radius 0: no merging
  uint32_t stride = 1;             ///< slots of a light subpath
  float density = 0;               ///< 1 / (π r² n), n: number of light subpaths
  uint32_t connections = 0;        ///< random connections per camera vertex
  float scale = 0;                 ///< of a connection: mean number of vertices of a light subpath over `connections`

  /// Adds the light of both to the camera subpath. `ray_id`: identity of the random choices at its last vertex.
  /// `caustics`: also gets the merged light that found_specularly() selects; nullptr: not wanted.
  template <typename Context, typename Recorder, typename Policy>
  RELUME_HD void add(const Context& c, const SurfacePoint& sp, uint32_t ray_id, CameraSubpath& e,
                     ConnectionRoulette& roulette, BdptCounters& counters, Recorder& recorder, Policy& policy,
                     CausticSum* caustics = nullptr) const {
    if (near.sorted.empty()) return;
    const uint32_t tried = leaves_out_surfaces<Policy>(e) ? 0 : connections;
    for (uint32_t i = 0; i < tried; ++i) connect(i, c, sp, ray_id, e, roulette, counters, recorder, policy);
    if (near.radius_squared > 0.0f) merge(c, sp, ray_id, e, recorder, policy, caustics);
  }

 private:
  /// Connects to a random vertex, number `i` at this camera vertex.
  template <typename Context, typename Recorder, typename Policy>
  RELUME_HD void connect(uint32_t i, const Context& c, const SurfacePoint& sp, uint32_t ray_id, CameraSubpath& e,
                         ConnectionRoulette& roulette, BdptCounters& counters, Recorder& recorder,
                         Policy& policy) const {
    constexpr uint32_t kSalt = 0x5c000000u;  // connections to one light subpath have small numbers
    const uint32_t id = hash(ray_id, kSalt + i);
    const auto chosen = static_cast<uint32_t>(uint64_t{hash(id)} * near.sorted.size >> 32);
    const uint32_t vertex = near.sorted[chosen].vertex;
    if (e.count() + vertex % stride + 2 > c.max_bidirectional_vertices()) return;
    Connection connection = connect_to_vertex(c, sp, e, vertices[vertex], kept_guide(c, guides, vertex), recorder);
    connection.contribution *= scale;
    try_connection(c, sp, connection, id, e, roulette, counters, recorder, policy);
  }

  template <typename Context, typename Recorder, typename Policy>
  RELUME_HD void merge(const Context& c, const SurfacePoint& sp, uint32_t ray_id, CameraSubpath& e, Recorder& recorder,
                       Policy& policy, CausticSum* caustics) const {
    const uint32_t longest = c.max_bidirectional_vertices();
    if (e.count() >= longest) return;
    const uint32_t most = longest - e.count();  // vertices of a light subpath with which paths are short enough
    // Reservoirs may add the light that reaches a primary hit directly. Their candidates are all lights
    // from which light subpaths start.
    const uint32_t first = e.path.bounce < c.path.first_nee_bounce ? 1u : 0u;
    Rgb sum(0);
    CausticSum focused;
    near.for_each_near(sp.position, [&](uint32_t vertex) {
      if (vertex % stride < first || vertex % stride >= most) return;
      const PathVertex& v = vertices[vertex];
      if (leaves_out_surfaces<Policy>(e) && vertex % stride > 0 && !found_specularly(v, vertex % stride)) return;
      if (!(std::fabs(glm::dot(v.ng, sp.ng)) >= kMinMergingCosine)) return;
      const Rgb merged = merged_radiance(c, sp, e, v, recorder);
      sum += merged;
      const Rgb light = e.path.throughput * merged * density;
      recorder.add(light, e.weights.at());
      if (e.path.bounce == 0) {
        c.first_light.offer(e.pixel, v.wo, light * unit_of<Policy>(e), hash(ray_id, vertex, 0x5d000000u));
      }
      if (caustics && found_specularly(v, vertex % stride)) focused.add(merged, vertex / stride);
      if constexpr (kIsPolicy<Policy>) {
        Connection found;
        found.ray.direction = v.wo;
        found.contribution = light;
        found.dispersed = c.scene().disperses && (e.path.dispersed || v.disperses(sp.wo));
        show_to_samples(policy, found);
        policy.connected(sp, e.path, found, true);
      }
    });
    e.path.radiance += e.path.throughput * sum * density;
    if (!caustics) return;
    caustics->light = e.path.throughput * focused.light * density;
    caustics->difference = e.path.throughput * focused.difference * density;
  }
};

/// LightVertexGrid for one camera subpath, which also sums the merged part of its caustic layer: light that light
/// subpaths found specularly, at the first vertex of the camera subpath that does not only scatter specularly.
struct GridWithCaustics {
  const LightVertexGrid& grid;
  CausticSum* caustics = nullptr;  ///< set to the sum, black at first; nullptr: not wanted
  bool* reached = nullptr;         ///< whether that vertex has been reached; false at first

  template <typename Context, typename Recorder, typename Policy>
  RELUME_HD void add(const Context& c, const SurfacePoint& sp, uint32_t ray_id, CameraSubpath& e,
                     ConnectionRoulette& roulette, BdptCounters& counters, Recorder& recorder, Policy& policy) const {
    const bool first = caustics && !*reached;
    if (first) *reached = true;
    grid.add(c, sp, ray_id, e, roulette, counters, recorder, policy, first ? caustics : nullptr);
  }
};

}  // namespace relume
