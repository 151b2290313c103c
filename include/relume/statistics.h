// Statistics of a session.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "relume/export.h"

namespace relume {

struct PassTime {
  std::string name;
  double seconds = 0;  ///< elapsed time
  double idle_s = 0;   ///< thread-seconds spent waiting for other threads

  /// Share of the time of `threads` threads without work.
  double idle_share(int threads) const { return seconds > 0 ? idle_s / (threads * seconds) : 0; }
};

/// A number that a pass reports, such as the number of cells in use or of dropped samples.
struct PassStatistic {
  std::string name;  ///< pass and number: "octree.leaves"
  double value = 0;
};

/// The GPU that renders.
struct DeviceStatistics {
  std::string name;                 ///< with its number: "NVIDIA H100 80GB HBM3 (cuda:0)"
  std::string driver;               ///< version of CUDA that the driver supports, such as "12.4"
  uint64_t memory_bytes = 0;        ///< memory of the GPU
  uint64_t memory_limit_bytes = 0;  ///< largest total of all sessions of the process on the GPU
  uint64_t memory_used_bytes = 0;   ///< total of these sessions at present
};

/// Totals since the session began. Counters are exact and do not depend on the number of threads.
struct Statistics {
  double build_s = 0;    ///< compiling the scene and building the acceleration structure
  double accel_s = 0;    ///< the part of build_s for the acceleration structure
  double render_s = 0;   ///< inside render_frame
  uint64_t frames = 0;   ///< complete frames
  uint64_t samples = 0;  ///< camera samples of all pixels
  uint64_t paths = 0;
  uint64_t rays = 0;               ///< path and shadow rays
  uint64_t nonfinite_samples = 0;  ///< samples with NaN or infinity, which count as black
  uint64_t scene_bytes = 0;        ///< the compiled scene
  uint64_t buffer_bytes = 0;       ///< per-pixel buffers, including spare memory for another image size
  uint64_t technique_bytes = 0;    ///< further structures of the passes
  int threads = 0;
  std::vector<PassTime> passes;
  std::vector<PassStatistic> pass_statistics;  ///< values of the last frame
  std::optional<DeviceStatistics> device;      ///< absent if the processor renders
};

/// Time of each pass of `now` since `before`. Passes that first ran later are missing in `before`. Includes "build"
/// (scene compilation) if `now` does.
RELUME_API std::vector<PassTime> pass_times_since(std::vector<PassTime> now, const std::vector<PassTime>& before);

}  // namespace relume
