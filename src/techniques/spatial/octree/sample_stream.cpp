#include "techniques/spatial/octree/sample_stream.h"

#include "core/stream_io.h"
#include "frame/primitives/fill.h"

namespace relume {

void SampleStream::resize(Backend& backend, uint32_t pixels, uint32_t vertices) {
  const size_t size = size_t{pixels} * vertices;
  if (samples_.size() != size) relume::resize(backend, "octree.group", samples_, size);
}

void SampleStream::group(Backend& backend, uint32_t region_count) {
  const View<const VertexSample> samples = samples_.view();
  group_by_key(PrimitiveLaunch{backend, "octree.group", scratch_}, SampleRegions{samples}, samples.size, region_count,
               groups_);
  counts_.reset(region_count, kUninitialized);
  launch(backend, "octree.group", CountSamplesKernel{groups_.begins.view(), counts_.mutable_view()}, region_count, 1,
         {}, kFillTile);
}

SampleGroupsView SampleStream::groups() const {
  return {samples_.view(), groups_.order.view(), groups_.begins.view(), counts_.view()};
}

void SampleStream::save(std::ostream& out) const { write_array(out, samples_); }
void SampleStream::load(std::istream& in) { read_array(in, samples_); }

size_t SampleStream::memory_bytes() const {
  return samples_.memory_bytes() + groups_.order.memory_bytes() + place_bytes() + scratch_.memory_bytes();
}

}  // namespace relume
