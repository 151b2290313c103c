// A path from a primary hit to a light, stored such that other pixels and frames can shift it to their primary hits.
// Vertices count from 0, the primary hit. A path has `length` vertices that scatter, followed by its end.
#pragma once

#include "scene/surface_place.h"
#include "techniques/reuse/reservoir/receiver.h"
#include "techniques/reuse/reservoir/reservoir.h"

namespace relume {

/// How a path meets light.
enum class PathEnd : uint32_t {
  none,        ///< no path
  connection,  ///< next event estimation at the last vertex
  emitter,     ///< a sampled direction meets an emitting surface
  infinity,    ///< a sampled direction leaves the scene
  cached,      ///< in all ways behind the vertex after the joint: the light that this vertex reflects, by a cache
};

/// The joint is the first vertex that all shifts of the path keep: vertex `joint`, or the end if that is `length`. Up
/// to the vertex before it, shifts repeat the path's random numbers. A joint of 0 means that they repeat all of them.
/// Integrands are densities over random numbers before the joint, area at the joint, solid angle of the direction that
/// leaves it (a connected light: over the coordinates of LightPoint), and random numbers after that. In this measure a
/// shift changes no coordinate, and its Jacobian is 1; in primary sample space, it is a ratio of Shifted::density.
struct StoredPath {
  static constexpr uint32_t kMostLength = 0x7ff;

  uint32_t pixel = 0;          ///< whose random numbers made the path
  uint32_t seed = 0;           ///< SampleIndex::seed of these numbers
  uint32_t sequence = 0;       ///< SampleIndex::sequence of them
  uint32_t element = 0;        ///< SampleIndex::sample_of() them
  uint32_t shape = 0;          ///< length, joint and end; of a cached end, the length is joint + 2
  uint32_t instance = kNoHit;  ///< surface of the joint; kNoHit: none
  uint32_t primitive = 0;
  float u = 0;  ///< as in Hit
  float v = 0;
  Vec3 leaving{0};  ///< direction that leaves the joint; to infinity, if that is the joint; x and y: coordinates of the
                    ///< connected light, if the joint is the last vertex or the end
  LightId light = kNoLight;  ///< light at the end, if the joint is the last vertex or the end; kNoLight: not selectable
  float light_pdf_w = 0;     ///< emitter after the joint: density of the end at the joint, given the light
  Rgb suffix{0};  ///< light that arrives at the joint along `leaving`, without weight of the wavelength unless cached;
                  ///< without MIS weight if the joint is the last vertex
  Rgb medium{0};  ///< absorption along `leaving`, per metre
  // In the domain that owns the path:
  Rgb value{0};   ///< integrand
  Vec3 first{0};  ///< direction at the primary hit; zero: from a delta lobe

  RELUME_HD static uint32_t shape_of(PathEnd end, uint32_t length, uint32_t joint, bool disperses) {
    return length | joint << 11u | static_cast<uint32_t>(end) << 22u | (disperses ? 1u << 25u : 0u);
  }
  RELUME_HD uint32_t length() const { return shape & kMostLength; }
  RELUME_HD uint32_t joint() const { return shape >> 11u & kMostLength; }
  RELUME_HD PathEnd end() const { return static_cast<PathEnd>(shape >> 22u & 7u); }
  /// Whether a vertex after the joint scatters by wavelength.
  RELUME_HD bool suffix_disperses() const { return (shape >> 25u & 1u) != 0u; }
  RELUME_HD bool valid() const { return end() != PathEnd::none; }
  RELUME_HD Hit hit() const { return {instance, primitive, u, v, kInfinity}; }
  RELUME_HD LightPoint light_point() const { return {light, Vec2(leaving.x, leaving.y)}; }
};

using PathReservoir = Reservoir<StoredPath>;
static_assert(sizeof(PathReservoir) == 116, "README.md states the memory per pixel");

/// Purposes of ChoiceNumbers.
inline constexpr uint32_t kChoosesPaths = 0x50540001u;
inline constexpr uint32_t kChoosesPathHistory = 0x50540002u;
inline constexpr uint32_t kChoosesPathNeighbours = 0x50540003u;
inline constexpr uint32_t kChoosesPathPairs = 0x50540004u;

/// Random numbers of a stored path. `index`: of any frame. Its seed is not used: it can differ from that of the path's
/// frame, as after movements of the camera.
RELUME_HD inline Sampler sampler_of(SampleIndex index, uint32_t width, const StoredPath& path) {
  index.seed = path.seed;
  index.sequence = path.sequence;
  index.sample = path.element;
  index.taken = {};
  return index.sampler(path.pixel % width, path.pixel / width);
}

/// Whether a path refers to existing surfaces and lights: instances can be hidden, and a damaged checkpoint may hold
/// any numbers.
RELUME_HD inline bool exists(const SceneView& scene, const StoredPath& path, uint32_t max_bounces) {
  const uint32_t length = path.length();
  const uint32_t joint = path.joint();
  if (!path.valid() || path.end() > PathEnd::cached || length == 0 || length > max_bounces || joint > length)
    return false;
  if (path.light != kNoLight && path.light >= scene.lights.lights.size) return false;
  const bool connects = path.end() == PathEnd::connection;
  if (connects && (joint == 0 || (joint + 1 >= length && path.light == kNoLight))) return false;
  if (path.end() == PathEnd::cached && (joint == 0 || joint + 2 != length)) return false;
  const bool has_surface = joint > 0 && (joint < length || path.end() == PathEnd::emitter);
  return !has_surface || exists(scene, path.hit());
}

}  // namespace relume
