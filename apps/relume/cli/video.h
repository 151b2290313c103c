// Image sequences as one video file, encoded by ffmpeg.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "cli/child_pipe.h"
#include "files/atomic_file.h"
#include "relume/image_io.h"

namespace relume::cli {

/// Whether the extension names a video: .mp4 or .y4m.
bool is_video_file(const std::filesystem::path& file);

/// Throws UsageError if ffmpeg is missing, the folder is not writable or `aovs` are requested.
void check_video_file(const std::filesystem::path& file, const std::vector<std::string>& aovs);

class VideoWriter {
 public:
  /// Frames of width × height at `fps`. Throws Error.
  VideoWriter(std::filesystem::path file, int width, int height, float fps);
  /// Without finish(), no file remains.
  ~VideoWriter();

  /// Appends a display-ready, still linear image. Throws Error if ffmpeg failed.
  void add(const Image& image);

  /// Completes the file and gives it its final name. Throws Error.
  void finish();

 private:
  [[noreturn]] void fail() const;

  std::filesystem::path file_;
  PendingFile pending_;
  std::vector<unsigned char> bytes_;
  std::unique_ptr<ChildPipe> encoder_;
};

}  // namespace relume::cli
