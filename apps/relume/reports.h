// What `render --stats`, `metrics --json` and `info --json` write, as JSON. Numbers that are not finite become null.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "relume/image_io.h"

namespace relume {
struct Metrics;
}

namespace relume::cli {

struct SceneSummary;

/// What a render did.
struct RunReport {
  std::string version;
  std::string scene;
  int width = 0;
  int height = 0;
  PixelWindow crop;              ///< of --crop; empty: none
  double samples_per_pixel = 0;  ///< of the last image, mean over its pixels
  std::string stopped_by;        ///< "samples", "time", "error", "interrupted"
  double estimated_error = 0;    ///< of the last image; infinite below two samples
  double load_s = 0;             ///< these times are of this run; counts below go on where a checkpoint left them
  double build_s = 0;
  double render_s = 0;
  double write_s = 0;
  uint64_t samples = 0;  ///< all pixels and images
  uint64_t paths = 0;
  uint64_t rays = 0;
  uint64_t nonfinite_samples = 0;
  int threads = 0;
  uint64_t peak_memory_bytes = 0;
  uint64_t scene_bytes = 0;                             ///< of geometry, lights, textures, acceleration structure
  uint64_t buffer_bytes = 0;                            ///< of the per-pixel buffers
  uint64_t technique_bytes = 0;                         ///< of what techniques hold besides
  std::vector<std::string> files;                       ///< images written
  std::vector<std::pair<std::string, double>> passes;   ///< name and seconds
  std::vector<std::pair<std::string, double>> figures;  ///< what techniques report of themselves
};

/// What `info` says about an image.
struct ImageReport {
  struct Channel {
    std::string name;
    float min = 0;
    float max = 0;
    size_t nonfinite = 0;  ///< values that neither counts; min > max if there are no others
  };
  int width = 0;
  int height = 0;
  std::vector<Channel> channels;                                ///< of an EXR
  std::vector<std::pair<std::string, std::string>> attributes;  ///< of an EXR: name and text
};

/// Extremes of what is finite, and how much is not.
ImageReport::Channel report_channel(const ExrChannel& channel);

/// A mean number of samples a pixel: "64", or "12.25" where it is not whole.
std::string format_samples(double samples);

/// An object with the members' names.
std::string to_json(const RunReport& report);
std::string to_json(const Metrics& metrics, bool with_hdr_flip);
std::string to_json(const ImageReport& report);
std::string to_json(const SceneSummary& summary);

}  // namespace relume::cli
