// Records ray queries between the renderer and Embree. The linker redirects every query of the program here (--wrap,
// see CMakeLists.txt), so that the log has the renderer's order and batches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "accel/embree/embree.h"

namespace relume {

/// Ray queries in call order.
class QueryLog {
 public:
  void add(const RTCRay& ray, bool occlusion);
  void add(const RTCRay8& rays, const int* valid, bool occlusion, bool coherent);

  /// Number of queries; a packet counts as one.
  size_t size() const { return queries_.size(); }

  /// Rays by kind; camera rays are those in packets of nearest-hit queries.
  uint64_t camera_rays = 0;
  uint64_t path_rays = 0;
  uint64_t shadow_rays = 0;
  uint64_t rays() const { return camera_rays + path_rays + shadow_rays; }

  /// Repeats queries [begin, end). Returns the sum of their results, which does not depend on their order.
  uint64_t replay(RTCScene scene, size_t begin, size_t end) const;

 private:
  struct Query {
    uint32_t index = 0;  ///< index in singles_ or packets_
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

/// Records all further queries to `log`, or none for nullptr. For a single thread.
void record_queries(QueryLog* log);

/// Scene of the last query, recorded or not.
RTCScene last_queried_scene();

/// Sum of the recorded queries' results, as in QueryLog::replay().
uint64_t recorded_sum();

}  // namespace relume
