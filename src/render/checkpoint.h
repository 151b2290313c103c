// Checkpoints: the persistent buffers of a session on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "film/buffer_table.h"
#include "render/render_settings.h"

namespace relume {

/// What must agree between the render that wrote a checkpoint and the one that continues it.
struct CheckpointHeader {
  uint64_t scene_hash = 0;
  std::string settings;  ///< checkpoint_key()
  uint32_t samples = 0;  ///< a pixel
};

/// The settings that samples depend on, as text: everything but the number of samples and threads.
std::string checkpoint_key(const RenderSettings& settings);

/// Writes header and persistent buffers to a temporary name, then renames. Throws Error.
void write_checkpoint(const std::filesystem::path& file, const CheckpointHeader& header, const BufferTable& buffers);

/// Fills the persistent buffers and returns the samples they hold. Throws Error if the file is damaged or belongs to
/// another scene or other settings (`expected.samples` is ignored); the buffers are then unchanged.
uint32_t read_checkpoint(const std::filesystem::path& file, const CheckpointHeader& expected, BufferTable& buffers);

}  // namespace relume
