// The previous frame of a pixel's surface: the pixel whose reservoir it reuses, and the placement of its instance.
#pragma once

#include "techniques/reuse/reservoir/receiver.h"
#include "techniques/reuse/reservoir/reservoir.h"
#include "techniques/temporal/reprojection/backward.h"

namespace relume {

/// The instance as it was placed in the previous frame. Meshes that deform keep their current shape.
RELUME_HD inline Instance previous_instance(const Instance& instance) {
  if (instance.in_world_space) return instance;
  Instance before = instance;
  before.to_world = instance.previous_to_world;
  before.normal_to_world = normal_matrix(before.to_world.linear);
  before.orientation = glm::dot(before.to_world.linear[0], before.normal_to_world[0]) < 0.0f ? -1.0f : 1.0f;
  return before;
}

/// The pixel that showed the surface of (x, y) in the previous frame: one of four, in proportion to its weight.
/// kNoSurface: none. `u`: uniform in [0, 1).
RELUME_HD inline uint32_t history_source(const BackwardReprojection& reprojection, uint32_t x, uint32_t y, float u) {
  const BackwardTaps taps = reprojection.taps(x, y);
  if (!taps.valid) return kNoSurface;
  float rest = u;
  for (int k = 0; k < 4; ++k) {
    if (!(taps.weights[k] > 0.0f)) continue;
    if (rest < taps.weights[k]) return taps.pixels[k];
    rest -= taps.weights[k];
  }
  return taps.heaviest();  // the weights sum to almost one
}

/// Reservoirs of the previous frame.
template <typename Sample>
struct ReservoirHistory {
  BackwardReprojection reprojection;
  View<const Reservoir<Sample>> reservoirs;
  View<const ReceiverRecord> records;  ///< receivers of the reservoirs
  float cap = 0;                       ///< largest confidence, in frames; 0: no history
  bool moved = false;                  ///< whether instances were placed differently in the previous frame
  bool holds = false;                  ///< whether reservoirs still hold for their receivers in this frame

  /// The pixel whose reservoir that of (x, y) reuses; kNoSurface: none. `u`: uniform in [0, 1).
  RELUME_HD uint32_t find(const SceneView& scene, uint32_t x, uint32_t y, float u) const {
    const uint32_t source = cap > 0.0f ? history_source(reprojection, x, y, u) : kNoSurface;
    if (source == kNoSurface || !(reservoirs[source].confidence > 0.0f)) return kNoSurface;
    const Hit& hit = records[source].hit;
    if (!exists(scene, hit)) return kNoSurface;
    const bool deforms = scene.meshes[scene.instances[hit.instance].mesh].deforms;
    return moved && deforms ? kNoSurface : source;  // the previous shape of such a mesh is not fully known
  }

  /// The reservoir of a pixel from find(), with limited confidence.
  RELUME_HD Reservoir<Sample> at(uint32_t source, float most_confidence) const {
    Reservoir<Sample> before = reservoirs[source];
    before.confidence = relume::min(before.confidence, most_confidence);
    return before;
  }

  /// Gives pixel (x, y), which has no path in this frame, the reservoir of its surface in the previous frame together
  /// with that reservoir's receiver: a domain of its own, which remains exact while the reservoirs hold. Otherwise, and
  /// without history, the pixel gets an empty reservoir, which no pixel or frame reuses. Returns the pixel that the
  /// reservoir comes from; kNoSurface: it is empty. `u`: uniform in [0, 1).
  RELUME_HD uint32_t keep(const SceneView& scene, uint32_t x, uint32_t y, float u, Reservoir<Sample>& reservoir,
                          ReceiverRecord& record) const {
    const uint32_t source = holds ? find(scene, x, y, u) : kNoSurface;
    if (source == kNoSurface) {
      reservoir = {};
      record = {};
    } else {
      reservoir = at(source, cap);  // as much as it counts in the history of a pixel with a path
      record = records[source];
    }
    return source;
  }

  /// The instance of the receiver of a reservoir from find(), as placed in the previous frame.
  RELUME_HD Instance instance_of(const SceneView& scene, uint32_t source) const {
    const Instance& instance = scene.instances[records[source].hit.instance];
    return moved ? previous_instance(instance) : instance;
  }
};

}  // namespace relume
