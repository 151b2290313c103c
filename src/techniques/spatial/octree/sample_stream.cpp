#include "techniques/spatial/octree/sample_stream.h"

#include <algorithm>

#include "core/parallel.h"
#include "core/stream_io.h"

namespace relume {
namespace {

/// Parts that are counted in parallel. Constant, so results do not depend on the machine.
constexpr uint32_t kChunks = 16;

}  // namespace

void SampleStream::resize(uint32_t pixels, uint32_t vertices) { samples_.resize(size_t{pixels} * vertices); }

void SampleStream::group(Backend& backend, uint32_t region_count) {
  backend.run("octree.group", [&] {
    const uint32_t size = static_cast<uint32_t>(samples_.size());
    const uint32_t chunk_size = (size + kChunks - 1) / kChunks;
    // By chunk and region: temporarily 64 bytes per region.
    std::vector<uint32_t> chunk_starts(size_t{kChunks} * region_count, 0);
    offsets_.resize(region_count);
    counts_.resize(region_count);
    const auto for_chunks = [&](const auto& f) {
      parallel_for(kChunks, [&](uint32_t chunk) {
        uint32_t* of_region = chunk_starts.data() + size_t{chunk} * region_count;
        const uint32_t end = std::min((chunk + 1) * chunk_size, size);
        for (uint32_t i = chunk * chunk_size; i < end; ++i) {
          if (samples_[i].region < region_count) f(i, of_region[samples_[i].region]);
        }
      });
    };
    for_chunks([](uint32_t, uint32_t& count) { ++count; });
    uint32_t next = 0;
    for (uint32_t region = 0; region < region_count; ++region) {
      offsets_[region] = next;
      for (uint32_t chunk = 0; chunk < kChunks; ++chunk) {
        uint32_t& start = chunk_starts[size_t{chunk} * region_count + region];
        const uint32_t count = start;
        start = next;
        next += count;
      }
      counts_[region] = next - offsets_[region];
    }
    order_.resize(next);
    for_chunks([this](uint32_t i, uint32_t& place) { order_[place++] = i; });
  });
}

SampleGroupsView SampleStream::groups() const {
  return {view_of(samples_), view_of(order_), view_of(offsets_), view_of(counts_)};
}

void SampleStream::save(std::ostream& out) const { write_vector(out, samples_); }
void SampleStream::load(std::istream& in) { read_vector(in, samples_); }

size_t SampleStream::memory_bytes() const {
  return samples_.capacity() * sizeof(VertexSample) + sizeof(uint32_t) * order_.capacity() + place_bytes();
}

size_t SampleStream::place_bytes() const { return sizeof(uint32_t) * (offsets_.capacity() + counts_.capacity()); }

}  // namespace relume
