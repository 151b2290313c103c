// JSON output of `render --stats`, `metrics --json` and `info --json`. Non-finite numbers become null.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "relume/image_io.h"
#include "relume/statistics.h"

namespace relume {
struct Metrics;
}

namespace relume::cli {

struct SceneSummary;

/// Statistics of a render.
struct RunReport {
  std::string version;
  std::string scene;
  int width = 0;
  int height = 0;
  PixelWindow crop;              ///< of --crop; empty: none
  double samples_per_pixel = 0;  ///< of the last image, mean over its pixels
  std::string stopped_by;        ///< "samples", "time", "error", "interrupted"
  double estimated_error = 0;    ///< of the last image; infinite below two samples
  double load_s = 0;             ///< these times are of this run; counts below continue from a checkpoint
  double build_s = 0;
  double accel_s = 0;
  double render_s = 0;
  double write_s = 0;
  uint64_t samples = 0;  ///< over all pixels and images
  uint64_t paths = 0;
  uint64_t rays = 0;
  uint64_t nonfinite_samples = 0;
  int threads = 0;
  uint64_t peak_memory_bytes = 0;
  uint64_t scene_bytes = 0;        ///< of geometry, lights, textures, acceleration structure
  uint64_t buffer_bytes = 0;       ///< of the per-pixel buffers
  uint64_t technique_bytes = 0;    ///< other memory of the techniques
  std::vector<std::string> files;  ///< images written
  std::vector<PassTime> passes;
  std::vector<std::pair<std::string, double>> figures;  ///< figures reported by techniques
  std::optional<DeviceStatistics> device;               ///< absent if the processor rendered
};

/// Report of `info` on an image.
struct ImageReport {
  struct Channel {
    std::string name;
    float min = 0;
    float max = 0;
    size_t nonfinite = 0;  ///< values counted in neither; min > max if there are no others
  };
  int width = 0;
  int height = 0;
  std::vector<Channel> channels;                                ///< of an EXR
  std::vector<std::pair<std::string, std::string>> attributes;  ///< of an EXR: name and text
};

/// Extremes of the finite values, and the number of the others.
ImageReport::Channel report_channel(const ExrChannel& channel);

/// A mean number of samples per pixel: "64", or "12.25" if fractional.
std::string format_samples(double samples);
/// "64 samples per pixel", or "1 sample per pixel".
std::string samples_text(double samples);

/// An object with the members' names.
std::string to_json(const RunReport& report);
std::string to_json(const Metrics& metrics, bool with_hdr_flip);
std::string to_json(const ImageReport& report);
std::string to_json(const SceneSummary& summary);

}  // namespace relume::cli
