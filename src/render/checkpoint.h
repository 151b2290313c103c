// Checkpoints: the persistent buffers of a session and what its passes remember, on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "frame/pipeline.h"
#include "framebuffer/buffer_table.h"
#include "render/render_settings.h"

namespace relume {

/// Where a session stands.
struct Counters {
  uint32_t frames = 0;        ///< complete ones
  uint32_t since_change = 0;  ///< of them, since anything changed
  uint32_t epoch = 0;         ///< edits that came after a frame: each has random numbers of its own
  float time_s = 0;           ///< of the animation
  float previous_time_s = 0;  ///< in the frame before
  float stretch_time_s = 0;   ///< of the first frame since anything changed
  uint32_t image_frames = 0;  ///< `frames` when the image that is being made began
  uint32_t sequence_age = 0;  ///< frames since a change started the sequences of samples
  uint64_t paths = 0;
  uint64_t rays = 0;
  uint64_t image_paths = 0;  ///< `paths` then
};
static_assert(sizeof(Counters) == 8 * sizeof(uint32_t) + 3 * sizeof(uint64_t));

/// What must agree between the render that wrote a checkpoint and the one that continues it, and the counters.
struct CheckpointHeader {
  uint64_t scene_hash = 0;
  std::string settings;  ///< checkpoint_key()
  Counters counters;
};

/// The settings that samples depend on, as text: everything but the number of samples, of threads, and the time, which
/// is one of the counters.
std::string checkpoint_key(const RenderSettings& settings);

/// Writes header, persistent buffers and the state of passes to a temporary name, then renames. Throws Error.
void write_checkpoint(const std::filesystem::path& file, const CheckpointHeader& header, const BufferTable& buffers,
                      const Pipeline& pipeline);

/// Fills the persistent buffers and the passes, and returns the counters. Throws Error if the file is damaged or
/// belongs to another scene or other settings (`expected.counters` is ignored), before anything changes. Only where a
/// file is whole and a pass still cannot take what it finds, the passes before that one have changed; no buffer has.
Counters read_checkpoint(const std::filesystem::path& file, const CheckpointHeader& expected, BufferTable& buffers,
                         Pipeline& pipeline);

}  // namespace relume
