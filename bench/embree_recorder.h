// Stands between the renderer and Embree: the linker sends every ray query of the program through here (--wrap, see
// CMakeLists.txt), so that what is recorded is what the renderer asks, in its order and batches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "accel/embree/embree.h"

namespace relume {

/// Ray queries in the order in which they were made.
class QueryLog {
 public:
  void add(const RTCRay& ray, bool occlusion);
  void add(const RTCRay8& rays, const int* valid, bool occlusion, bool coherent);

  /// Queries; a packet is one.
  size_t size() const { return queries_.size(); }

  /// Rays by kind; camera rays are what came in packets of nearest-hit queries.
  uint64_t camera_rays = 0;
  uint64_t path_rays = 0;
  uint64_t shadow_rays = 0;
  uint64_t rays() const { return camera_rays + path_rays + shadow_rays; }

  /// Sum of what queries [begin, end) found, which does not depend on their order. Runs them anew.
  uint64_t replay(RTCScene scene, size_t begin, size_t end) const;

 private:
  struct Query {
    uint32_t index = 0;  ///< into singles_ or packets_
    bool packet = false;
    bool occlusion = false;
    bool coherent = false;
  };
  struct Packet {
    RTCRay8 rays;
    alignas(32) int valid[8];
  };

  std::vector<Query> queries_;
  std::vector<RTCRay> singles_;
  std::vector<Packet> packets_;
};

/// From here on, or until nullptr is given, queries are added to `log`; from one thread only.
void record_queries(QueryLog* log);

/// The scene that was asked last, recording or not.
RTCScene last_queried_scene();

/// Sum of what was found while recording, as QueryLog::replay() adds it up.
uint64_t recorded_sum();

}  // namespace relume
