// What paths leave behind for the next frame: one record for each of the first vertices of each pixel's path, at a
// fixed address, so that nothing depends on the order of threads. Grouping then brings the records of one region
// together.
#pragma once

#include <iosfwd>
#include <vector>

#include "core/view.h"
#include "frame/launch.h"
#include "lights/light.h"
#include "techniques/spatial/octree/octree.h"

namespace relume {

/// Vertices of a path that leave records, at most.
inline constexpr uint32_t kMaxRecordedVertices = 4;

struct VertexSample {
  uint32_t region = kNoRegion;  ///< leaf to which it belongs; kNoRegion: no record
  uint32_t light = kNoLight;    ///< sampled by next event estimation, with kVisibleLight; or kNoLight
  uint32_t direction = 0;       ///< in which the path went on, 16 bits a coordinate of the octahedral square
  float value = 0;              ///< luminance of Li cos θ / pdf_w found there; 0 if the path ended
  uint32_t densities = 0;       ///< pdf_w, and that of the guide alone (pack_densities())
};

/// Two positive numbers with 8 bits of precision each.
RELUME_HD inline uint32_t pack_densities(float pdf_w, float guide_pdf_w) {
  return (float_bits(pdf_w) & 0xffff0000u) | (float_bits(guide_pdf_w) >> 16);
}
RELUME_HD inline float unpack_density(uint32_t densities) { return bits_float(densities & 0xffff0000u); }
RELUME_HD inline float unpack_guide_density(uint32_t densities) { return bits_float(densities << 16); }

/// Flag in VertexSample::light: nothing was in between.
inline constexpr uint32_t kVisibleLight = 0x80000000u;

/// Records by region. Each region's are in the order of their addresses.
struct SampleGroupsView {
  View<const VertexSample> samples;
  View<const uint32_t> order;    ///< addresses, region by region
  View<const uint32_t> offsets;  ///< by leaf slot, into `order`
  View<const uint32_t> counts;   ///< by leaf slot

  RELUME_HD const VertexSample& sample(uint32_t region, uint32_t i) const {
    return samples[order[offsets[region] + i]];
  }
};

/// Owns the records of one frame and their grouping.
class SampleStream {
 public:
  /// Makes room for `vertices` records a pixel. Of as many pixels as before, what the first vertices left stays.
  void resize(uint32_t pixels, uint32_t vertices);

  /// Record of vertex v at pixel p: element v · pixels + p.
  View<VertexSample> samples() { return mutable_view_of(samples_); }

  /// Groups the records over regions [0, region_count). The order is that of a stable sort by region, whatever the
  /// number of threads.
  void group(Backend& backend, uint32_t region_count);
  SampleGroupsView groups() const;

  size_t memory_bytes() const;
  /// Of what each region has: where its records stand, and how many.
  size_t place_bytes() const;
  /// The records; grouping is not kept.
  void save(std::ostream& out) const;
  void load(std::istream& in);

 private:
  std::vector<VertexSample> samples_;
  std::vector<uint32_t> order_;
  std::vector<uint32_t> offsets_;
  std::vector<uint32_t> counts_;
};

}  // namespace relume
