// A rendered frame of a sequence as a message, and the files made from such frames.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "cli/render_setup.h"
#include "cli/video.h"
#include "ranks/message.h"
#include "relume/image_io.h"

namespace relume::ranks {

struct FrameImage {
  size_t index = 0;    ///< in the sequence
  double samples = 0;  ///< per pixel
  double render_s = 0;
  uint64_t rays = 0;
  bool in_studio = false;
  ExrFile exr;  ///< image, layers and metadata; data_window: that of --crop
};

Bytes to_message(const FrameImage& frame);
FrameImage frame_of_message(const Bytes& bytes);

/// Writes frames in order, because an automatic exposure adapts from frame to frame and videos grow by frames.
class FrameWriter {
 public:
  FrameWriter(const cli::RenderOptions& options, const cli::RenderSetup& setup, std::string identity);

  /// Continues from the checkpoint. Throws Error if it belongs to another sequence.
  void resume();
  /// Takes a frame, and writes those that are next. Returns their number.
  size_t add(FrameImage frame);
  /// Completes a video.
  void finish();
  /// Index of the next frame to write.
  size_t next() const { return next_; }

 private:
  void write(const FrameImage& frame);
  void save() const;

  const cli::RenderOptions& options_;
  const cli::RenderSetup& setup_;
  std::string identity_;
  size_t next_ = 0;
  std::optional<float> exposure_;  ///< of the last frame, if automatic
  std::map<size_t, FrameImage> waiting_;
  std::optional<cli::VideoWriter> video_;
};

}  // namespace relume::ranks
