// Samples that paths record for the next frame: one for each of the first vertices of each pixel's path. Records have
// fixed addresses, so the result does not depend on the order of threads. Afterwards they are grouped by region.
#pragma once

#include <iosfwd>
#include <vector>

#include "core/array.h"
#include "core/view.h"
#include "frame/launch.h"
#include "frame/primitives/group_by_key.h"
#include "lights/light.h"
#include "techniques/spatial/octree/octree.h"

namespace relume {

/// Maximum number of recorded vertices per path.
inline constexpr uint32_t kMaxRecordedVertices = 4;

struct VertexSample {
  uint32_t region = kNoRegion;  ///< leaf of the vertex; kNoRegion: no record
  uint32_t light = kNoLight;    ///< light sampled by next event estimation, with kVisibleLight; or kNoLight
  uint32_t direction = 0;       ///< direction in which the path continued: octahedral, 16 bits per coordinate
  float value = 0;              ///< luminance of Li cos θ / pdf_w · BsdfSample::resampling; 0 if the path ended
  uint32_t densities = 0;       ///< pdf_w of the mixture and of the guiding distribution (pack_densities())
  uint32_t bsdf = 0;            ///< luminance and pdf_w of the BSDF along `direction`; 0: not guided, or delta lobes
  float weight = 1;  ///< number of paths that the record stands for; 0: none, it only names the region (culled paths)
};

/// Importance that arrived at a recorded vertex of a camera subpath. It has the address of the vertex's VertexSample,
/// which names its region and weight.
struct ImportanceSample {
  uint32_t direction = 0;  ///< direction from which it came, to the previous vertex: octahedral, 16 bits per coordinate
  float value = 0;         ///< luminance of the throughput; 0 until the subpath has scattered other than specularly
};

/// Packs two numbers, not negative, with 8 bits of precision each.
RELUME_HD inline uint32_t pack_densities(float pdf_w, float guide_pdf_w) {
  return (float_bits(pdf_w) & 0xffff0000u) | (float_bits(guide_pdf_w) >> 16);
}
RELUME_HD inline float unpack_density(uint32_t densities) { return bits_float(densities & 0xffff0000u); }
RELUME_HD inline float unpack_guide_density(uint32_t densities) { return bits_float(densities << 16); }

/// Flag in VertexSample::light: the shadow ray was unoccluded.
inline constexpr uint32_t kVisibleLight = 0x80000000u;

/// Records grouped by region, within a region in the order of their addresses.
struct SampleGroupsView {
  View<const VertexSample> samples;
  View<const uint32_t> order;                    ///< addresses, region by region
  View<const uint32_t> offsets;                  ///< first index into `order`, by leaf slot; then the total
  View<const uint32_t> counts;                   ///< number of records, by leaf slot
  View<const ImportanceSample> importance = {};  ///< by address; empty: not recorded

  RELUME_HD uint32_t address(uint32_t region, uint32_t i) const { return order[offsets[region] + i]; }
  RELUME_HD const VertexSample& sample(uint32_t region, uint32_t i) const { return samples[address(region, i)]; }
};

/// The region of each record; kNoRegion for those of culled paths.
struct SampleRegions {
  View<const VertexSample> samples;

  RELUME_HD uint32_t operator()(size_t i) const {
    const VertexSample& sample = samples.data[i];
    return sample.weight > 0.0f ? sample.region : kNoRegion;
  }
};

/// Writes the number of each region's records.
struct CountSamplesKernel {
  View<const uint32_t> offsets;
  View<uint32_t> counts;

  RELUME_HD void operator()(uint32_t region, uint32_t) const { counts[region] = offsets[region + 1] - offsets[region]; }
};

/// Owns the records of one frame and their grouping.
class SampleStream {
 public:
  explicit SampleStream(Memory& memory = host_memory())
      : samples_(memory), importance_(memory), groups_(memory), counts_(memory) {}

  /// Allocates `vertices` records per pixel. If the number of pixels is unchanged, the first vertices keep their
  /// records. `importance`: also for samples of importance.
  void resize(Backend& backend, uint32_t pixels, uint32_t vertices, bool importance = false);

  /// Record of vertex v at pixel p: element v · pixels + p.
  View<VertexSample> samples() { return samples_.mutable_view(); }
  /// The same for importance; empty if it is not recorded.
  View<ImportanceSample> importance() { return importance_.mutable_view(); }

  /// Groups the records of regions [0, region_count). The order is that of a stable sort by region with any number of
  /// threads.
  void group(Backend& backend, uint32_t region_count);
  SampleGroupsView groups() const;

  size_t memory_bytes() const;
  /// Bytes of the offsets and counts of regions.
  size_t place_bytes() const { return groups_.begins.memory_bytes() + counts_.memory_bytes(); }
  /// Saves the records without their grouping. `importance`, here and in load(): as for resize().
  void save(std::ostream& out, bool importance = false) const;
  /// Sets the stream's failbit if the numbers of records differ.
  void load(std::istream& in, bool importance = false);

 private:
  Array<VertexSample> samples_;
  Array<ImportanceSample> importance_;  ///< as many, or empty
  KeyGroups groups_;
  Array<uint32_t> counts_;
  PrimitiveScratch scratch_;
};

}  // namespace relume
