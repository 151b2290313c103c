// Frames of an animation and their file names.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace relume::cli {

struct FrameRange {
  int first = 0;
  int last = 0;  ///< inclusive
  int count() const { return last - first + 1; }
};

/// Parses "0-99", "0..99" or a single "12". Throws UsageError that begins with `place`.
FrameRange parse_frame_range(std::string_view text, std::string_view place);

/// Time of a frame, with frame 0 at `scene_time_s`. Throws UsageError beyond the latest animation time.
float frame_time_s(int frame, float fps, float scene_time_s);

/// File name of each frame of a sequence.
class FrameNames {
 public:
  /// The file name of `pattern` holds "####" (zero-padded to as many digits), "%d" or "%04d". Without one, the number
  /// precedes the extension ("out.exr": "out.0007.exr"). Throws UsageError for any other or a second '%' or '#'.
  explicit FrameNames(const std::filesystem::path& pattern);

  std::filesystem::path operator()(int frame) const;

 private:
  std::filesystem::path folder_;
  std::string before_;
  std::string after_;
  size_t digits_ = 4;
};

}  // namespace relume::cli
