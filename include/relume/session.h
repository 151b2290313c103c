// A rendering session: a scene, its settings, and the frames rendered so far. Calls may come from any thread, but never
// from two at once. Separate sessions are independent.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "relume/buffers.h"
#include "relume/export.h"
#include "relume/image_io.h"
#include "relume/records.h"
#include "relume/scene.h"
#include "relume/settings.h"
#include "relume/statistics.h"
#include "relume/tone_map.h"

namespace relume {

/// Identifies a part of a session's scene. An index into Scene's arrays converts to a handle.
template <typename Part>
struct Handle {
  Index index = kNone;
  uint64_t session = 0;  ///< number of the session that the handle belongs to; 0: not checked (a plain index)

  constexpr Handle() = default;
  // NOLINTNEXTLINE(google-explicit-constructor): an index names its part, too
  constexpr Handle(Index i, uint64_t owner = 0) : index(i), session(owner) {}
  friend bool operator==(const Handle&, const Handle&) = default;
};
using NodeHandle = Handle<Node>;
using MeshHandle = Handle<Mesh>;
using MaterialHandle = Handle<Material>;
using LightHandle = Handle<PunctualLight>;

/// A pass of a frame.
struct PassInfo {
  std::string name;
  std::string stage;  ///< prepare, hits, gbuffer, history, allocate, sampled-hits, trace, resolve, present or denoise
};

class RELUME_API Session {
 public:
  /// Compiles the scene. `movable` lists nodes that set_transform() will move, besides animated ones. Ignores
  /// Scene::settings_json and the settings for stopping and display: the caller applies them. Throws Error (unknown
  /// camera or node, incompatible settings).
  explicit Session(Scene scene, const Settings& settings = {}, std::vector<Index> movable = {});
  ~Session();
  Session(Session&&) noexcept;
  Session& operator=(Session&&) noexcept;

  /// Renders one frame: one sample for each pixel that adaptive sampling selects. Returns false if `stop` came first:
  /// the image and all state of later frames are as before, but per-frame buffers (depth, …) may contain parts of the
  /// abandoned frame. A frame that has updated a radiance cache is completed. Exceptions discard histories and caches.
  /// After the loss of a GPU, images and state on it cannot be read any more: these functions throw its error again.
  bool render_frame(std::stop_token stop = {});

  /// Once `token` is requested, long preparation that a later frame can continue (static light lists) ends early.
  /// Frames are unbiased but noisier until the preparation is complete.
  void shorten_preparation_on(std::stop_token token);
  /// Whether all preparation was complete as of the last frame. Only then does a checkpoint continue with the same bits
  /// as an uninterrupted session.
  bool prepared() const;

  /// Discards all samples, histories and caches, and sets the seed. The next frames equal those of a new session with
  /// the scene in its present state. Of statistics(), only the times are kept.
  void restart(int seed);

  /// Frames since the last change.
  uint32_t frames_since_change() const;
  /// Mean number of samples per pixel in the image. Adaptive sampling makes it lower than the number of frames; a
  /// history that survives a change makes it higher.
  double kept_samples() const;

  /// Begins a new image with the next frame, for example of a sequence, whether or not anything has changed. Resets the
  /// counters below, but keeps samples and histories.
  void begin_image();
  /// Frames since begin_image(), or since the session began.
  uint32_t image_frames() const;
  /// Mean number of samples per pixel in these frames.
  double image_samples() const;
  /// Seconds spent in render_frame() for these frames, except those loaded from a checkpoint.
  double image_render_s() const;

  // Changes of the scene between frames. Histories are kept where they stay valid; without a history, samples start
  // over. These calls throw Error for values out of range, and with the code invalid_handle for parts that are not in
  // the scene. If memory is missing or a GPU fails, the time and the environment keep their values, and other changes
  // take effect with the next frame. That frame rebuilds the scene, and throws if this fails, too.

  /// Moves animated nodes and parameters to a time in the range of the setting "scene-time".
  void set_time(float time_s);
  /// Renders with this camera; std::nullopt: with the scene's own camera, which the setting "camera" selects.
  void set_camera(const std::optional<CameraPose>& camera);
  /// The camera that frames are rendered with.
  CameraPose camera() const;
  /// Sets the transform from the node to its parent. It replaces Node::matrix and ends the animation of that transform.
  /// The node or an ancestor must be animated, movable (see the constructor) or added by add_node().
  void set_transform(NodeHandle node, const Transform& transform);
  void set_light(LightHandle light, const PunctualLight& value);
  void set_environment(const Environment& environment);
  void set_material(MaterialHandle material, const Material& value);

  /// Add parts to the scene. A node refers to meshes and lights by Handle::index and may be moved. The acceleration
  /// structure is rebuilt before the next frame; histories and caches start over. The session can no longer save or
  /// load checkpoints. Throw Error for invalid values and references; nothing is added then.
  MaterialHandle add_material(const Material& material);
  MeshHandle add_mesh(const Mesh& mesh);
  LightHandle add_light(const PunctualLight& light);
  NodeHandle add_node(const Node& node);
  /// Remove a node with its descendants, or a mesh or light that no node uses. Their handles become invalid. Throw
  /// Error (invalid_handle) for parts that are not in the scene.
  void remove(NodeHandle node);
  void remove(MeshHandle mesh);
  void remove(LightHandle light);
  /// The first node with that name. Throws Error (not_found) if none has it.
  NodeHandle find_node(const std::string& name) const;

  /// Uses other settings from the next frame on. Returns false if they affect how the scene is compiled and so need a
  /// new session. Throws Error as the constructor does; the session then keeps its settings. So it does if memory is
  /// missing or a GPU fails, except perhaps for the time.
  bool set_settings(const Settings& settings);

  /// Mean radiance of the last complete frame, denoised if a denoiser is set. Changes show with the next frame; black
  /// before the first.
  Image image() const;
  /// The same, in memory that later frames never modify.
  std::shared_ptr<const Image> snapshot() const;
  /// Copies the image to the caller's memory without allocating. `curve` and `exposure` (stops) apply to
  /// PixelLayout::rgba8. Throws Error unless the target has memory and the size of the image.
  void read(const ImageTarget& target, ToneMap curve = ToneMap::agx, float exposure = 0) const;

  /// Shows `image` in place of the session's until the next complete frame, for example one denoised by a hook of
  /// on_pass(). The histories keep their content. Throws Error unless it has the session's size.
  void replace_image(const Image& image);

  /// Per-pixel buffers that can be inspected.
  std::vector<BufferInfo> buffers() const;
  /// One of these buffers. Throws Error for an unknown name.
  BufferData buffer(const std::string& name) const;

  /// Write access to a buffer, for techniques under development. Between frames it changes the history; in a hook of
  /// on_pass() it changes what later passes read. Throws Error as buffer() does.
  std::span<std::byte> edit_buffer(const std::string& name);

  /// Data structures of the techniques that can be inspected.
  std::vector<RecordTable> record_tables() const;
  /// The records of one of these tables. Throws Error for an unknown name.
  RecordData records(const std::string& name) const;

  /// The passes of a frame, in order.
  std::vector<PassInfo> passes() const;
  /// Calls `hook` with the name of each pass after the pass has run, on the rendering thread. Empty: removes the hook.
  /// Exceptions of the hook end the frame as those of a pass do. Hooks may read the session, edit_buffer() and
  /// replace_image(); calls that change the session throw Error.
  void on_pass(std::function<void(const std::string& pass)> hook);

  /// Estimated relative error of the image: the root of the mean variance of the pixel means, divided by the mean
  /// luminance. Infinite below two samples.
  double estimated_error() const;

  /// Names of the arbitrary output variables of these settings: albedo, normal, depth, motion, variance, …
  static std::vector<std::string> aov_names(const Settings& settings);
  /// Planes of one output variable as of the last frame, with their conventional EXR channel names ("albedo.R"). Layers
  /// that accumulate, such as albedo, are means over the frames since the last change. Throws Error for an unknown
  /// name.
  std::vector<ExrChannel> aov(const std::string& name) const;

  const Statistics& statistics() const;
  /// Whether the studio environment lights the scene: Environment::kind selects it, or nothing else lights the scene.
  bool in_studio() const;
  /// Defaults that the session chose for missing parts of the scene, one sentence each.
  const std::vector<std::string>& notes() const;
  /// Problems that affect the results so far, one sentence each.
  std::vector<std::string> warnings() const;
  /// Hash of all scene content that affects the image, as of the session's construction.
  uint64_t scene_hash() const;

  /// Write and read the state from which rendering continues bit for bit. Throw Error for failed writes and reads, and
  /// when loading if the scene or the settings differ.
  void save_checkpoint(const std::filesystem::path& file) const;
  void load_checkpoint(const std::filesystem::path& file);

 private:
  friend struct SessionAccess;
  struct State;
  explicit Session(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace relume
