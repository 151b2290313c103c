// A rendering session: a scene, its settings, and the frames rendered so far. Used frame by frame, on any thread, by
// one thread at a time.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "relume/buffers.h"
#include "relume/export.h"
#include "relume/image_io.h"
#include "relume/scene.h"
#include "relume/settings.h"
#include "relume/statistics.h"
#include "relume/tone_map.h"

namespace relume {

/// Names a part of a session's scene. Parts of the scene that the session was constructed with are also named by their
/// index.
template <typename Part>
struct Handle {
  Index index = kNone;
  uint64_t session = 0;  ///< number of the session; 0: named by index

  constexpr Handle() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): an index names its part, too
  constexpr Handle(Index i, uint64_t owner = 0) : index(i), session(owner) {}
  friend bool operator==(const Handle&, const Handle&) = default;
};
using NodeHandle = Handle<Node>;
using MeshHandle = Handle<Mesh>;
using MaterialHandle = Handle<Material>;
using LightHandle = Handle<PunctualLight>;

class RELUME_API Session {
 public:
  /// Compiles the scene. `movable` names nodes that set_transform() will move beside animated ones. Of the settings,
  /// those of scene files, stopping and display are left to the caller. Throws Error (unknown camera, settings that do
  /// not combine).
  explicit Session(Scene scene, const Settings& settings = {}, std::vector<Index> movable = {});
  ~Session();
  Session(Session&&) noexcept;
  Session& operator=(Session&&) noexcept;

  /// Renders one frame: one sample for each pixel that the allocation selects. Returns false if `stop` was requested
  /// first; image and techniques are then as if the frame had not begun, and so is everything that later frames depend
  /// on. Buffers of a single frame, such as depth and normal, hold what that frame has written of them. Radiance caches
  /// finish a frame whose samples have joined their cells. An exception discards histories and caches.
  bool render_frame(std::stop_token stop = {});

  /// Once `token` is requested, long preparation that a later frame can continue (static light lists) ends early.
  /// Frames until then are unbiased, but noisier.
  void shorten_preparation_on(std::stop_token token);
  /// Whether all preparation has been completed, as of the last frame. Checkpoints of a session that is not prepared
  /// continue with other bits than an uninterrupted one has.
  bool prepared() const;

  /// Discards all samples, histories and caches, and sets another seed, as a new session of the scene in its present
  /// state would. Only the times of passes are kept.
  void restart(int seed);

  /// Frames since the last change.
  uint32_t frames_since_change() const;
  /// Samples per pixel in the image, averaged over the pixels: fewer than frames if the allocation skips pixels, more
  /// if a history survived a change.
  double kept_samples() const;

  /// Begins an image, with the next frame: of a sequence, say, whether anything has changed or not.
  void begin_image();
  /// Frames since begin_image(), or since the session began.
  uint32_t image_frames() const;
  /// Samples per pixel in these frames, averaged over the pixels.
  double image_samples() const;
  /// Seconds inside render_frame() in these frames, without those of a loaded checkpoint.
  double image_render_s() const;

  /// Change the scene from one frame to the next. Histories keep what they can; without one, samples start over. Times
  /// lie in the range of the setting "scene-time". Throw Error (invalid_handle) for parts that are not in the scene.
  void set_time(float time_s);
  void set_camera(const std::optional<CameraPose>& camera);
  /// The camera that frames are rendered with.
  CameraPose camera() const;
  void set_transform(NodeHandle node, const Transform& transform);
  void set_light(LightHandle light, const PunctualLight& value);
  void set_environment(const Environment& environment);
  void set_material(MaterialHandle material, const Material& value);

  /// Add parts to the scene. A node refers to meshes and lights by Handle::index, and may be moved. The acceleration
  /// structure is built again before the next frame, histories and caches start over, and the session can no longer
  /// save or load checkpoints. Throw Error for values and references that are not valid; then nothing is added.
  MaterialHandle add_material(const Material& material);
  MeshHandle add_mesh(const Mesh& mesh);
  LightHandle add_light(const PunctualLight& light);
  NodeHandle add_node(const Node& node);
  /// Remove a node with the nodes below it, or a mesh or light that no node has. Their handles are invalid afterwards.
  /// Throw Error (invalid_handle) for parts that are not in the scene.
  void remove(NodeHandle node);
  void remove(MeshHandle mesh);
  void remove(LightHandle light);
  /// The first node of that name. Throws Error (not_found) if there is none.
  NodeHandle find_node(const std::string& name) const;

  /// Uses other settings from the next frame on. Returns false if only a new session can use them, because they decide
  /// how the scene is compiled. Throws Error as the constructor does; the session then keeps its settings.
  bool set_settings(const Settings& settings);

  /// Mean radiance of the last complete frame, denoised if the settings say so. Changes show with the next frame; black
  /// before the first.
  Image image() const;
  /// The same, in memory that later frames never change.
  std::shared_ptr<const Image> snapshot() const;
  /// Copies the same to the caller's memory, without allocating. `curve` and `exposure` (stops) are for
  /// PixelLayout::rgba8. Throws Error unless the target has memory and the session's size.
  void read(const ImageTarget& target, ToneMap curve = ToneMap::agx, float exposure = 0) const;

  /// Per-pixel buffers that can be inspected.
  std::vector<BufferInfo> buffers() const;
  /// One of them. Throws Error for a name that is not among them.
  BufferData buffer(const std::string& name) const;

  /// Calls `hook` with the name of each pass after it has run, on the thread that renders. Empty: no more.
  void on_pass(std::function<void(const std::string& pass)> hook);

  /// Estimated relative error of the image: root of the mean variance of the pixel means over the mean
  /// luminance; infinite below two samples.
  double estimated_error() const;

  /// Names of the arbitrary output variables with these settings: albedo, normal, depth, motion, variance, … .
  static std::vector<std::string> aov_names(const Settings& settings);
  /// Planes of one of them with their conventional EXR channel names. Throws Error for an unknown name.
  std::vector<ExrChannel> aov(const std::string& name) const;

  const Statistics& statistics() const;
  /// Whether the scene is lit by the studio environment, as its Environment::kind asks or because nothing else lights
  /// it.
  bool in_studio() const;
  /// Defaults that the session chose because the scene lacks something, one sentence each.
  const std::vector<std::string>& notes() const;
  /// Problems that affect the results so far, one sentence each.
  std::vector<std::string> warnings() const;
  /// Hash of everything in the scene that the image depends on, as it was when the session was constructed.
  uint64_t scene_hash() const;

  /// Writes or reads all state that is needed to continue with the same bits. Loading throws Error if scene or settings
  /// differ.
  void save_checkpoint(const std::filesystem::path& file) const;
  void load_checkpoint(const std::filesystem::path& file);

 private:
  friend struct SessionAccess;
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace relume
