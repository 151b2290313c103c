// A rendering session: a scene, its settings, and the buffers that frames fill. Usable as a library call, frame
// by frame, on any thread; one thread at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>
#include <vector>

#include "film/buffer_table.h"
#include "io/image.h"
#include "render/render_settings.h"
#include "scene/scene.h"

namespace relume {

struct PassTime {
  std::string name;
  double seconds = 0;
};

/// What has been done since the session began. Counters are exact and do not depend on the number of threads.
struct Statistics {
  double build_s = 0;    ///< compiling the scene and building the acceleration structure
  double render_s = 0;   ///< inside render_frame
  uint64_t samples = 0;  ///< camera samples, all pixels together
  uint64_t paths = 0;
  uint64_t rays = 0;  ///< path and shadow rays
  uint64_t nonfinite_samples = 0;
  int threads = 0;
  std::vector<PassTime> passes;
};

class Session {
 public:
  /// Compiles the scene. Throws Error (unknown camera, a combination of slots without meaning).
  Session(Scene scene, const RenderSettings& settings);
  ~Session();
  Session(Session&&) noexcept;
  Session& operator=(Session&&) noexcept;

  /// Adds one sample to every pixel. Returns false if `stop` was requested first; the image then holds the
  /// samples of complete frames only.
  bool render_frame(std::stop_token stop = {});

  /// Samples a pixel so far.
  uint32_t sample_count() const;

  /// Moves the animation; accumulated samples are dropped.
  void set_time(float time_s);

  /// Mean radiance so far.
  Image image() const;

  /// Estimated relative error of the image: root of the mean variance of the pixel means over the mean
  /// luminance; infinite below two samples.
  double estimated_error() const;

  /// Names of the arbitrary output variables: albedo, normal, depth, motion, variance, … .
  static const std::vector<std::string>& aov_names();
  /// Planes of one of them with their conventional EXR channel names. Throws Error for an unknown name.
  std::vector<ExrChannel> aov(const std::string& name) const;

  const Statistics& statistics() const;
  const RenderSettings& settings() const;
  /// What the session did on its own account ("no light in the file: a constant environment stands in").
  const std::vector<std::string>& notes() const;
  /// Hash of everything in the scene that the picture depends on.
  uint64_t scene_hash() const;

  /// The per-pixel buffers, for inspection.
  const BufferTable& buffers() const;

  /// Everything needed to continue later, bit for bit. Load throws Error if scene or settings differ.
  void save_checkpoint(const std::filesystem::path& file) const;
  void load_checkpoint(const std::filesystem::path& file);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace relume
