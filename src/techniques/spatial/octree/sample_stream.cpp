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
    const std::span<const VertexSample> samples = samples_.read();
    const uint32_t size = static_cast<uint32_t>(samples.size());
    const uint32_t chunk_size = (size + kChunks - 1) / kChunks;
    // By chunk and region: temporarily 64 bytes per region.
    std::vector<uint32_t> chunk_starts(size_t{kChunks} * region_count, 0);
    offsets_.reset(region_count, kUninitialized);
    counts_.reset(region_count, kUninitialized);
    const std::span<uint32_t> offsets = offsets_.write();
    const std::span<uint32_t> counts = counts_.write();
    const auto for_chunks = [&](const auto& f) {
      parallel_for(kChunks, [&](uint32_t chunk) {
        uint32_t* of_region = chunk_starts.data() + size_t{chunk} * region_count;
        const uint32_t end = std::min((chunk + 1) * chunk_size, size);
        for (uint32_t i = chunk * chunk_size; i < end; ++i) {
          if (samples[i].region < region_count) f(i, of_region[samples[i].region]);
        }
      });
    };
    for_chunks([](uint32_t, uint32_t& count) { ++count; });
    uint32_t next = 0;
    for (uint32_t region = 0; region < region_count; ++region) {
      offsets[region] = next;
      for (uint32_t chunk = 0; chunk < kChunks; ++chunk) {
        uint32_t& start = chunk_starts[size_t{chunk} * region_count + region];
        const uint32_t count = start;
        start = next;
        next += count;
      }
      counts[region] = next - offsets[region];
    }
    order_.reset(next, kUninitialized);
    const std::span<uint32_t> order = order_.write();
    for_chunks([&](uint32_t i, uint32_t& place) { order[place++] = i; });
  });
}

SampleGroupsView SampleStream::groups() const {
  return {samples_.view(), order_.view(), offsets_.view(), counts_.view()};
}

void SampleStream::save(std::ostream& out) const { write_array(out, samples_); }
void SampleStream::load(std::istream& in) { read_array(in, samples_); }

size_t SampleStream::memory_bytes() const { return samples_.memory_bytes() + order_.memory_bytes() + place_bytes(); }

size_t SampleStream::place_bytes() const { return offsets_.memory_bytes() + counts_.memory_bytes(); }

}  // namespace relume
