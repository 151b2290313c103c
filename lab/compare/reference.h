// References: rendered once, with an estimate of their own error, and cached in a folder.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "metrics/temporal.h"
#include "relume/image_io.h"
#include "render/session.h"

namespace relume {

struct Reference {
  Image image;
  double mse = 0;      ///< expected, of the reference against the true image: a quarter of the MSE between its halves
  double rel_mse = 0;  ///< the same for relMSE
  /// The same per pixel and channel: a quarter of the squared difference between the halves. Empty: unknown.
  Image squared_error = {};
  int spp = 0;  ///< 0: an external file with unknown error
  bool cached = false;
  double render_s = 0;         ///< in this run
  SurfaceMotion surface = {};  ///< surfaces at the pixels, and their motion since `previous_time_s`
};

/// One of a reference's two images with independent seeds.
struct ReferenceHalf {
  Image image;
  std::vector<ExrChannel> surface = {};  ///< motion, depth and normal; of the first half only
};

/// Called after every frame with the completed fraction, in [0, 1].
using ReferenceProgress = std::function<void(double fraction)>;

/// Renders references of one scene with one set of settings. The two halves of a reference have independent seeds.
/// Interrupted references leave checkpoints in the folder and continue next time.
class ReferenceRenderer {
 public:
  /// `spp` samples per pixel in total, half of them in each half. `scene` must outlive this. The folder is created if
  /// needed. References of another `program` are not reused, since its light transport may differ. Throws Error if the
  /// folder cannot be created.
  ReferenceRenderer(const Scene& scene, const RenderSettings& settings, int spp, std::filesystem::path folder,
                    std::string program = {});

  /// The reference at a time of the animation, from `camera` if given. Returns std::nullopt if `stop` was requested
  /// first.
  std::optional<Reference> render(float time_s, float previous_time_s, const std::optional<CameraPose>& camera,
                                  const std::stop_token& stop, const ReferenceProgress& progress);
  /// The same without motion.
  std::optional<Reference> render(float time_s, const std::stop_token& stop, const ReferenceProgress& progress) {
    return render(time_s, time_s, std::nullopt, stop, progress);
  }

  // The steps of render(), for halves that other processes render.

  /// The reference from its file; std::nullopt if there is none.
  std::optional<Reference> find(float time_s, float previous_time_s, const std::optional<CameraPose>& camera) const;
  /// Renders half 0 or 1. Returns std::nullopt if `stop` was requested first.
  std::optional<ReferenceHalf> render_half(int half, float time_s, float previous_time_s,
                                           const std::optional<CameraPose>& camera, const std::stop_token& stop,
                                           const ReferenceProgress& progress);
  /// The reference of two halves; writes its file, and removes their checkpoints.
  Reference combine(float time_s, float previous_time_s, const std::optional<CameraPose>& camera,
                    std::array<ReferenceHalf, 2> halves) const;
  /// Removes checkpoints of halves that another process has combined.
  void remove_checkpoints(float time_s, float previous_time_s, const std::optional<CameraPose>& camera) const;

  /// Frees the memory of the session, which the next half creates again.
  void close_session() { session_.reset(); }

  const RenderSettings& settings() const { return settings_; }
  /// File in which this reference is, or will be, cached.
  std::filesystem::path file(float time_s, float previous_time_s, const std::optional<CameraPose>& camera) const;

 private:
  bool render_samples(int half, const std::filesystem::path& checkpoint, const std::stop_token& stop,
                      const ReferenceProgress& progress);
  Session& session();

  const Scene& scene_;
  RenderSettings settings_;
  int half_spp_;
  std::filesystem::path folder_;
  std::string program_;
  uint64_t scene_hash_;
  std::unique_ptr<Session> session_;  ///< created on first use
};

/// Reads an image for a comparison. Throws Error, also for an EXR with only a window of its image: the rest is unknown.
Image read_whole_image(const std::filesystem::path& file);

/// Reads an external reference. Throws Error.
Reference read_reference(const std::filesystem::path& file);

}  // namespace relume
