// Records ray queries between the renderer and Embree. The linker redirects every query of the program here (--wrap,
// see CMakeLists.txt), so that the log has the renderer's order and batches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "accel/accel.h"
#include "accel/embree/embree.h"

namespace relume {

/// Ray queries in call order.
class QueryLog {
 public:
  void add(const RTCRay& ray, bool occlusion);
  void add(const RTCRay16& rays, const int* valid, bool occlusion);

  /// Number of queries; a packet counts as one.
  size_t size() const { return queries_.size(); }

  /// Rays by kind: of the camera and along paths, and towards lights.
  uint64_t nearest_rays = 0;
  uint64_t shadow_rays = 0;
  uint64_t rays() const { return nearest_rays + shadow_rays; }

  /// Repeats queries [begin, end). Returns the sum of their results, which does not depend on their order.
  uint64_t replay(RTCScene scene, size_t begin, size_t end) const;

 private:
  struct Query {
    uint32_t index = 0;  ///< index in singles_ or packets_
    bool packet = false;
    bool occlusion = false;
  };
  struct Packet {
    RTCRay16 rays;
    alignas(64) int valid[kPacketSize];
  };

  std::vector<Query> queries_;
  std::vector<RTCRay> singles_;
  std::vector<Packet> packets_;
};

/// Records all further queries to `log`, or none for nullptr. For a single thread.
void record_queries(QueryLog* log);

/// Scene of the last query, recorded or not.
RTCScene last_queried_scene();

/// Sum of the recorded queries' results, as in QueryLog::replay().
uint64_t recorded_sum();

}  // namespace relume
