// Keys of the hash grid ([Binder19], algorithm 1). They distinguish the position, jittered in the tangent plane and
// quantised at a level of detail, the normal, the direction and the layer.
#pragma once

#include <bit>

#include "core/frame.h"
#include "core/hash.h"
#include "core/math.h"
#include "scene/surface_point.h"
#include "techniques/spatial/hash_grid/change.h"

namespace relume {

/// The inputs of a key. Compact, so that a pass can store them and a later pass finds the same cell.
struct CellPoint {
  Vec3 position{0};         ///< jittered position in world space, metres
  uint32_t normal = 0;      ///< quantised normal; from bit kNormalBits: in half as many steps, if keys use both
  uint32_t direction = 0;   ///< quantised direction to the viewer, or 0; from bit kNormalBits: roughness, or 0
  uint16_t layer = 0;       ///< separates depths or lobes
  uint16_t coarsening = 0;  ///< levels above the level of detail of the position
};

/// Bits of a quantised normal or direction.
inline constexpr int kNormalBits = 19;

/// 2^exponent, for exponents of normal floating-point numbers.
RELUME_HD inline float power_of_two(int exponent) {
  return std::bit_cast<float>(static_cast<uint32_t>(exponent + 127) << 23);
}
RELUME_HD inline double wide_power_of_two(int exponent) {
  return std::bit_cast<double>(static_cast<uint64_t>(exponent + 1023) << 52);
}

/// Bijective 64-bit mixer: multiplications between shifts, as in [Steele14] with the constants of its variant 13.
RELUME_HD constexpr uint64_t mixed(uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// The hashes of a key. `bucket_hash` chooses the slots to probe. `fingerprint`, never 0, identifies the key there.
struct CellAddress {
  uint64_t fingerprint = 0;
  uint32_t bucket_hash = 0;
};

/// Coarsest and finest cells: edges of 2^level metres.
inline constexpr int kMinCellLevel = -48;
inline constexpr int kMaxCellLevel = 48;

/// The resolution s(k) of keys and their hashes. Cells scale with the footprint of a pixel, so no scene needs tuning.
struct CellKeys {
  Vec3 camera{0};
  float cone_width = 0;    ///< width of a pixel's footprint at the camera, metres
  float cone_spread = 0;   ///< growth of the footprint per metre of distance
  float cell_size = 8;     ///< edge of a cell in footprints; rounded to the nearest power of two in metres
  int normal_bins = 2;     ///< steps of a normal's component in [0, 1]; 0: normals are not distinguished
  int direction_bins = 0;  ///< the same for directions of directional points
  bool jitter = true;
  int roughness_bins = 0;       ///< steps of the roughness in [0, 1]; 0: roughness is not distinguished
  bool halved_normals = false;  ///< whether coarser substitutes distinguish half as many steps of normals

  /// Exponent of the cells' edge at `p`: edge = 2^level metres.
  RELUME_HD int level_of_detail(const Vec3& p) const {
    const float edge = cell_size * (cone_width + cone_spread * glm::length(p - camera));
    if (!(edge > power_of_two(kMinCellLevel))) return kMinCellLevel;
    if (!(edge < power_of_two(kMaxCellLevel))) return kMaxCellLevel;
    constexpr float kSqrt2 = 1.41421356f;  // rounds the logarithm to the nearest integer
    return static_cast<int>(float_bits(edge * kSqrt2) >> 23) - 127;
  }

  /// Level of the cell of `p`.
  RELUME_HD int level_of(const CellPoint& p) const {
    return level_of_detail(p.position) + static_cast<int>(p.coarsening);
  }

  /// Moves `p` by up to half a cell along each axis of its tangent plane. Keys use the level at the new position.
  RELUME_HD Vec3 jittered(const Vec3& p, const Vec3& ng, const Vec2& u, int coarsening = 0) const {
    if (!jitter) return p;
    const float edge = power_of_two(level_of_detail(p) + coarsening);
    const Frame tangent = make_frame(ng);
    return p + ((u.x - 0.5f) * edge) * tangent.t + ((u.y - 0.5f) * edge) * tangent.b;
  }

  /// The inputs of the key of `sp`. `u` in [0, 1)² is for the jitter, `roughness` in [0, 1] the mean of the lobes. Keys
  /// distinguish the direction to the viewer if `directional`. With `coarsening`, they use geometric normals in steps
  /// twice as large, because normal maps vary within such cells.
  RELUME_HD CellPoint point(const SurfacePoint& sp, const Vec2& u, uint16_t layer, bool directional,
                            uint16_t coarsening = 0, float roughness = 1) const {
    uint32_t normal = coarsening == 0 ? bins(sp.frame.n, normal_bins) : bins(sp.ng, (normal_bins + 1) / 2);
    if (halved_normals && coarsening == 0)
      normal |= bins(sp.frame.n, (normal_bins + 1) / 2, kHalvedBase) << kNormalBits;
    uint32_t direction = directional ? bins(sp.wo, direction_bins) : 0u;
    if (roughness_bins > 0) direction |= roughness_bin(roughness) << kNormalBits;
    return {jittered(sp.position, sp.ng, u, coarsening), normal, direction, layer, coarsening};
  }

  /// Quantises a roughness to steps of 1/roughness_bins, from 1.
  RELUME_HD uint32_t roughness_bin(float roughness) const {
    return 1u + math::truncate_to_uint(saturate(roughness) * static_cast<float>(roughness_bins) + 0.5f);
  }

  /// Quantises components to steps of 1/count. Axis-aligned directions are in the middle of their bins. Components
  /// outside [-1, 1] and NaN have defined bins, too.
  RELUME_HD static uint32_t bins(const Vec3& d, int count, uint32_t base = 64) {
    if (count <= 0) return 0;
    const float steps = static_cast<float>(count);
    const auto bin = [&](float x) { return math::truncate_to_uint((x + 1.0f) * steps + 0.5f); };
    return 1u + bin(d.x) + base * (bin(d.y) + base * bin(d.z));
  }

  /// Address of the cell that contains `p`, `coarser` levels above its own. Substitutes for undersampled cells are
  /// separate from the ordinary cells of their level, because their samples have another probability. With −1, the cell
  /// is finer; its layer should differ from that of ordinary cells.
  RELUME_HD CellAddress address(const CellPoint& p, int coarser = 0) const {
    return address_at(glm::dvec3(p.position), p, level_of(p) + coarser, coarser > 0 ? coarser : 0);
  }

  /// Address of the cell at `position` with the other inputs of `p`. Cell indices are
  /// clamped to 64 bits per axis, so all cells beyond share the address of the last one.
  RELUME_HD CellAddress address_at(const glm::dvec3& position, const CellPoint& p, int level, int coarser) const {
    const glm::dvec3 cell = glm::floor(grid_position(position, level));
    const glm::i64vec3 whole(math::truncate_to_int64(cell.x), math::truncate_to_int64(cell.y),
                             math::truncate_to_int64(cell.z));
    return address_of(whole, p, level, coarser);
  }

  /// Centre of the cell at `level` that contains `p`, metres.
  RELUME_HD glm::dvec3 middle(const Vec3& p, int level) const {
    const glm::dvec3 cell = glm::floor(grid_position(glm::dvec3(p), level));
    return (cell + 0.5 - grid_shift(level)) * wide_power_of_two(level);
  }

  /// Position in units of cells. Each level's grid has its own shift, and none has a plane through the origin. Walls
  /// often have round coordinates, where rounding errors would split their cells.
  RELUME_HD glm::dvec3 grid_position(const glm::dvec3& position, int level) const {
    return position * wide_power_of_two(-level) + grid_shift(level);
  }
  RELUME_HD static glm::dvec3 grid_shift(int level) {
    return glm::dvec3(0.7548776662, 0.5698402910, 0.8191725134) * (static_cast<double>(level) + 0.5);
  }

  /// Hashes of the key. The level is in both ([Binder19] omits it). Normal and direction are only in the fingerprint,
  /// so cells of one voxel are neighbours in the table.
  RELUME_HD CellAddress address_of(const glm::i64vec3& v, const CellPoint& p, int level, int coarser) const {
    const auto cell_kind =
        static_cast<uint64_t>(int64_t{level - kMinCellLevel} * (1 << 18) + coarser * (1 << 16) + p.layer);
    const uint64_t place = place_of(v, cell_kind);
    // Coarsened cells are separate from the ordinary cells of the same level.
    const uint64_t coarsened = p.coarsening > 0 ? uint64_t{1} << 63 : 0;
    const uint32_t normal = normal_in(p, coarser);
    const uint64_t facing = (coarsened | static_cast<uint64_t>(p.direction) << 32 | normal) * 0xdb4f0b9175ae2165u;
    CellAddress result;
    const uint64_t region = mixed(place_of(v >> int64_t{kRegionLevels}, cell_kind));
    result.bucket_hash =
        (static_cast<uint32_t>(mixed(place) >> 32) & ~(kRegions - 1)) | region_of(static_cast<uint32_t>(region));
    result.fingerprint = mixed(place + facing + 0x2545f4914f6cdd1du);
    if (result.fingerprint == 0) result.fingerprint = 1;
    return result;
  }

 private:
  static constexpr uint32_t kHalvedBase = 17;  ///< values of a component in at most eight steps

  /// The normal that the key of a cell `coarser` levels above that of `p` distinguishes.
  RELUME_HD uint32_t normal_in(const CellPoint& p, int coarser) const {
    if (!halved_normals || p.coarsening > 0) return p.normal;
    return coarser > 0 ? p.normal >> kNormalBits : p.normal & ((1u << kNormalBits) - 1u);
  }

  /// A sum with large odd factors. Two keys have the same sum only if they are millions of cells apart.
  RELUME_HD static uint64_t place_of(const glm::i64vec3& v, uint64_t cell_kind) {
    return static_cast<uint64_t>(v.x) * 0x9e3779b97f4a7c15u + static_cast<uint64_t>(v.y) * 0xd1b54a32d192ed03u +
           static_cast<uint64_t>(v.z) * 0xabc98388fb8fac03u + cell_kind * 0x8cb92ba72f3d8dd7u;
  }
};

}  // namespace relume
