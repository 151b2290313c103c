// A rendering session: a scene, its settings, and the buffers that frames fill. Usable as a library call, frame
// by frame, on any thread; one thread at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/change.h"
#include "frame/pass.h"
#include "framebuffer/buffer_table.h"
#include "image/image.h"
#include "render/render_settings.h"
#include "scene/compiled_scene.h"
#include "scene/scene.h"

namespace relume {

struct PassTime {
  std::string name;
  double seconds = 0;
};

/// What each pass of `now` has taken since `before`, which may lack passes that had not run by then. "build", compiling
/// the scene, is among them if it is in `now`.
std::vector<PassTime> pass_times_since(std::vector<PassTime> now, const std::vector<PassTime>& before);

/// What has been done since the session began. Counters are exact and do not depend on the number of threads.
struct Statistics {
  double build_s = 0;    ///< compiling the scene and building the acceleration structure
  double render_s = 0;   ///< inside render_frame
  uint64_t frames = 0;   ///< complete ones
  uint64_t samples = 0;  ///< camera samples, all pixels together
  uint64_t paths = 0;
  uint64_t rays = 0;  ///< path and shadow rays
  uint64_t nonfinite_samples = 0;
  uint64_t scene_bytes = 0;      ///< of CompiledScene
  uint64_t buffer_bytes = 0;     ///< of the table of buffers
  uint64_t technique_bytes = 0;  ///< of what the passes hold besides
  int threads = 0;
  std::vector<PassTime> passes;
  std::vector<PassFigure> figures;  ///< what techniques report of themselves, as of the last frame
};

class Session {
 public:
  /// Compiles the scene; `movable` names nodes that set_transform() will move beside animated ones. Throws Error
  /// (unknown camera, a combination of slots without meaning).
  Session(Scene scene, const RenderSettings& settings, std::vector<Index> movable = {});
  ~Session();
  Session(Session&&) noexcept;
  Session& operator=(Session&&) noexcept;

  /// Renders one frame: a sample for every pixel that the allocation gives one. Returns false if `stop` was requested
  /// first; the image then holds the samples of complete frames only. Techniques that adapt finish their frame.
  bool render_frame(std::stop_token stop = {});

  /// Once `token` is requested, preparation that takes long and that a later frame can continue (static light lists)
  /// ends early, and frames are rendered with what there is: unbiased, but noisier.
  void shorten_preparation_on(std::stop_token token);
  /// Whether all preparation has been completed, as of the last frame. Checkpoints of a session that is not prepared
  /// continue with other bits than an uninterrupted one has.
  bool prepared() const;

  /// Forgets everything that frames have found out, histories and caches included, and goes on with other random
  /// numbers from the present state of the scene, as a new session would; only the times of passes go on.
  void restart(int seed);

  /// Frames since the last change. What pixels keep of their samples, and of those before, kept_samples() says.
  uint32_t frames_since_change() const;
  /// Samples that a pixel's mean is made of, mean over the pixels: fewer than frames where allocation leaves some out,
  /// more where a history went on over a change.
  double kept_samples() const;

  /// The next frame is the first of a picture of its own, whether anything has changed or not. Checkpoints know.
  void begin_picture();
  /// Frames since then, or since the session began.
  uint32_t picture_frames() const;
  /// Samples that a pixel got in them, mean over the pixels.
  double picture_samples() const;
  /// Seconds inside render_frame since then, without those that a loaded checkpoint's frames took.
  double picture_render_s() const;

  /// What changes from one frame to the next. Histories keep what they can; without one, samples start anew.
  /// Times lie in the range of the setting "scene-time". Throws Error for an index that the scene does not have.
  void set_time(float time_s);
  void set_camera(const std::optional<PlacedCamera>& camera);
  void set_transform(Index node, const Transform& transform);
  void set_light(Index light, const PunctualLight& value);
  void set_environment(const Environment& environment);
  void set_material(Index material, const Material& value);
  /// False if only a new session can take these settings on (they concern how the scene is compiled). Throws Error as
  /// the constructor does; the session then keeps its settings.
  bool set_settings(const RenderSettings& settings);

  /// Mean radiance so far, denoised if the settings say so.
  Image image() const;

  /// Estimated relative error of the image: root of the mean variance of the pixel means over the mean
  /// luminance; infinite below two samples.
  double estimated_error() const;

  /// Names of the arbitrary output variables with these settings: albedo, normal, depth, motion, variance, … .
  static std::vector<std::string> aov_names(const RenderSettings& settings);
  /// Planes of one of them with their conventional EXR channel names. Throws Error for an unknown name.
  std::vector<ExrChannel> aov(const std::string& name) const;

  const Statistics& statistics() const;
  const RenderSettings& settings() const;
  /// What the session did on its own account ("no light in the file: a constant environment stands in").
  const std::vector<std::string>& notes() const;
  /// What a user should know of the frames so far: results suffered.
  std::vector<std::string> warnings() const;
  /// Hash of everything in the scene that the picture depends on, as it was loaded.
  uint64_t scene_hash() const;
  const CompiledScene& scene() const;

  /// The per-pixel buffers and the passes that fill them, for inspection.
  const BufferTable& buffers() const;
  std::vector<PassDeclaration> passes() const;

  /// Everything needed to continue later, bit for bit. Load throws Error if scene or settings differ.
  void save_checkpoint(const std::filesystem::path& file) const;
  void load_checkpoint(const std::filesystem::path& file);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace relume
