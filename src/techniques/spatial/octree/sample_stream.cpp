#include "techniques/spatial/octree/sample_stream.h"

#include "core/stream_io.h"
#include "frame/primitives/fill.h"

namespace relume {

void SampleStream::resize(Backend& backend, uint32_t pixels, uint32_t vertices, bool importance) {
  const size_t size = size_t{pixels} * vertices;
  if (samples_.size() != size) relume::resize(backend, "octree.group", samples_, size);
  const size_t of_importance = importance ? size : 0;
  if (importance_.size() != of_importance) relume::resize(backend, "octree.group", importance_, of_importance);
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
  return {samples_.view(), groups_.order.view(), groups_.begins.view(), counts_.view(), importance_.view()};
}

void SampleStream::save(std::ostream& out, bool importance) const {
  write_array(out, samples_);
  if (importance) write_array(out, importance_);
}

void SampleStream::load(std::istream& in, bool importance) {
  read_array(in, samples_);
  importance_.clear();
  if (!importance) return;
  read_array(in, importance_);
  if (importance_.empty() || importance_.size() == samples_.size()) return;
  importance_.clear();
  in.setstate(std::ios::failbit);
}

size_t SampleStream::memory_bytes() const {
  return samples_.memory_bytes() + importance_.memory_bytes() + groups_.order.memory_bytes() + place_bytes() +
         scratch_.memory_bytes();
}

}  // namespace relume
