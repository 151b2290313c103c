#include "render/sample_blocks.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "framebuffer/shared_buffers.h"
#include "render/sample_parts.h"
#include "render/session_access.h"
#include "render/summed_layers.h"
#include "techniques/temporal/accumulate/sample_sums_pass.h"

namespace relume {
namespace {

constexpr BufferKey<uint32_t> kRaysOfPixel{"heatmap"};

/// Buffers with sums over the samples of a pixel.
constexpr std::array<std::string_view, 5> kSumBuffers = {kRadianceSums.name, kSampleBlock.name, kSurfaceSums.name,
                                                         kRaysOfPixel.name, kNonfinite.name};

/// Elements of a buffer for the host; empty if the session lacks it.
template <typename T>
std::span<T> writable(BufferTable& buffers, const BufferKey<T>& key) {
  Buffer* const buffer = buffers.find(key.name);
  if (!buffer) return {};
  const std::span<std::byte> bytes = buffer->bytes();
  return {reinterpret_cast<T*>(bytes.data()), bytes.size() / sizeof(T)};
}

}  // namespace

void begin_samples(Session& session, uint32_t first) {
  auto& s = SessionAccess::state(session);
  s.check_between_frames();
  s.settings.samples.first = first;
  if (samples_adapt(s.settings)) {
    s.rebuild_pipeline();
  } else {
    s.backend->run(kSessionWork, [&] {
      for (const auto& buffer : s.buffers->all()) {
        if (buffer->description().persistent) buffer->clear();
      }
    });
  }
  const Counters before = s.counters;
  s.counters = s.first_counters();
  s.counters.paths = before.paths;
  s.counters.rays = before.rays;
  s.summed.clear();
  s.replacement.clear();
  s.drop_kept_image();
}

void skip_samples(Session& session, uint32_t next) {
  auto& s = SessionAccess::state(session);
  s.check_between_frames();
  s.counters.frames = s.counters.since_change = s.counters.sequence_age = next;
}

void take_samples(Session& session, std::span<PixelSums> total) {
  auto& s = SessionAccess::state(session);
  s.check_between_frames();
  s.backend->run(kSessionWork, [&] {
    add_sums(*s.buffers, total);
    for (const std::string_view name : kSumBuffers) {
      if (Buffer* const buffer = s.buffers->find(name)) buffer->clear();
    }
  });
  s.summed.clear();
}

void set_samples(Session& session, std::span<const PixelSums> sums, uint32_t samples) {
  auto& s = SessionAccess::state(session);
  s.check_between_frames();
  uint64_t rays = 0;
  s.backend->run(kSessionWork, [&] {
    const std::span<RadianceSums> radiance = writable(*s.buffers, kRadianceSums);
    const std::span<SampleBlock> blocks = writable(*s.buffers, kSampleBlock);
    const std::span<SurfaceSums> surfaces = writable(*s.buffers, kSurfaceSums);
    const std::span<uint32_t> rays_of_pixels = writable(*s.buffers, kRaysOfPixel);
    const std::span<uint32_t> nonfinite = writable(*s.buffers, kNonfinite);
    for (size_t i = 0; i < sums.size(); ++i) {
      radiance[i] = sums[i].radiance;
      blocks[i] = {};
      if (!surfaces.empty()) surfaces[i] = sums[i].surface;
      rays_of_pixels[i] = sums[i].rays;
      nonfinite[i] = sums[i].nonfinite;
      rays += sums[i].rays;
    }
    std::ranges::fill(writable(*s.buffers, kSamples), samples);
  });
  s.settings.samples.first = 0;
  s.counters.frames = s.counters.since_change = s.counters.sequence_age = samples;
  s.counters.image_frames = 0;
  s.counters.image_paths = 0;
  s.counters.paths = s.rendered_pixels() * samples;
  s.counters.rays = rays;
  s.summed.clear();
}

}  // namespace relume
