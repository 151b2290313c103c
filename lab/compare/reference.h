// References: rendered once, with their own error stated, and kept in a folder for the next time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>

#include "metrics/temporal.h"
#include "relume/image_io.h"
#include "render/session.h"

namespace relume {

struct Reference {
  Image image;
  double mse = 0;      ///< expected, of the reference against the truth: a quarter of the MSE between its halves
  double rel_mse = 0;  ///< likewise
  /// Of the same in each pixel and channel: a quarter of the squared difference between the halves. Empty: not known.
  Image squared_error = {};
  int spp = 0;  ///< 0: a file from elsewhere, whose error is not known
  bool cached = false;
  double render_s = 0;         ///< in this run
  SurfaceMotion surface = {};  ///< what the pixels show, and how it moved since `previous_time_s`
};

/// Told after every frame: share of the work done, in [0, 1].
using ReferenceProgress = std::function<void(double fraction)>;

/// Renders references of one scene with one set of settings. The two halves of a reference have independent seeds.
/// What is interrupted leaves checkpoints in the folder and goes on next time.
class ReferenceRenderer {
 public:
  /// `spp` samples a pixel, half of them in each half. `scene` outlives this. The folder is made if need be. What
  /// another `program` left there is not used: light may have travelled differently in it. Throws Error if the folder
  /// cannot be made.
  ReferenceRenderer(const Scene& scene, const RenderSettings& settings, int spp, std::filesystem::path folder,
                    std::string program = {});

  /// The reference at a time of the animation, seen by `camera` if there is one. std::nullopt if `stop` was requested
  /// first.
  std::optional<Reference> render(float time_s, float previous_time_s, const std::optional<CameraPose>& camera,
                                  const std::stop_token& stop, const ReferenceProgress& progress);
  /// Without motion.
  std::optional<Reference> render(float time_s, const std::stop_token& stop, const ReferenceProgress& progress) {
    return render(time_s, time_s, std::nullopt, stop, progress);
  }

  const RenderSettings& settings() const { return settings_; }
  /// The file in which such a reference is, or will be, kept.
  std::filesystem::path file(float time_s, float previous_time_s, const std::optional<CameraPose>& camera) const;

 private:
  bool render_half(int half, const std::filesystem::path& checkpoint, const std::stop_token& stop,
                   const ReferenceProgress& progress);
  Session& session();

  const Scene& scene_;
  RenderSettings settings_;
  int half_spp_;
  std::filesystem::path folder_;
  std::string program_;
  uint64_t scene_hash_;
  std::unique_ptr<Session> session_;  ///< made when something is to be rendered
};

/// An image that is compared. Throws Error, also for an EXR that stores a window of its image: the rest is not known.
Image read_whole_image(const std::filesystem::path& file);

/// A reference made elsewhere. Throws Error.
Reference read_reference(const std::filesystem::path& file);

}  // namespace relume
