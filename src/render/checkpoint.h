// Checkpoints: the persistent buffers of a session and the state of its passes, on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "frame/pipeline.h"
#include "framebuffer/buffer_table.h"
#include "render/render_settings.h"

namespace relume {

/// Progress of a session.
struct Counters {
  uint32_t frames = 0;        ///< complete frames
  uint32_t since_change = 0;  ///< complete frames since the last change
  uint32_t epoch = 0;         ///< number of edits that followed a frame; each starts separate random numbers
  float time_s = 0;           ///< time of the animation
  float previous_time_s = 0;  ///< time of the previous frame
  float stretch_time_s = 0;   ///< time of the first frame since the last change
  uint32_t image_frames = 0;  ///< `frames` at the start of the current image
  uint32_t sequence_age = 0;  ///< frames since a change started the sample sequences
  uint64_t paths = 0;
  uint64_t rays = 0;
  uint64_t image_paths = 0;  ///< `paths` at the start of the current image
};
static_assert(sizeof(Counters) == 8 * sizeof(uint32_t) + 3 * sizeof(uint64_t));

/// Data that must match between the render that wrote a checkpoint and the one that continues it, and the counters.
struct CheckpointHeader {
  uint64_t scene_hash = 0;
  std::string settings;  ///< checkpoint_key()
  Counters counters;
};

/// The settings that samples depend on, as text: all except the number of samples, the number of threads, the form of
/// kernels, and the time, which is a counter.
std::string checkpoint_key(const RenderSettings& settings);

/// Writes header, persistent buffers and pass state under a temporary name, then renames the file. Throws Error.
void write_checkpoint(const std::filesystem::path& file, const CheckpointHeader& header, const BufferTable& buffers,
                      const Pipeline& pipeline);

/// Restores the persistent buffers and the passes, and returns the counters. Throws Error before any change if the file
/// is damaged or belongs to another scene or other settings (`expected.counters` is ignored). If the file is intact but
/// a pass rejects its state, earlier passes have changed, but no buffer.
Counters read_checkpoint(const std::filesystem::path& file, const CheckpointHeader& expected, BufferTable& buffers,
                         Pipeline& pipeline);

}  // namespace relume
