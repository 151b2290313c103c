// One side of the viewer: a session that follows requests.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "viewer/render/request.h"

namespace relume::viewer {

/// Pixels of a frame, and those that get a path.
struct FrameScale {
  IVec2 size{0};
  int upscale = 1;                  ///< edge of the blocks of pixels with one path per frame
  bool switches_upscaling = false;  ///< whether `upscale` may change from frame to frame
};

class SessionSlot {
 public:
  /// Applies the settings and edits of `request` for this side, at `scale`. Recompiles the scene only for edits
  /// that the session cannot apply. A change starts a new image. Throws Error, leaving an existing session unchanged.
  void update(const RenderRequest& request, int side, const FrameScale& scale);

  /// Start of the compilation in progress, by now_s(); std::nullopt if there is none. Callable from any thread.
  std::optional<double> compiling_since_s() const;
  /// The same for the whole of update(), except the scene's time and camera, which change from frame to frame.
  std::optional<double> updating_since_s() const;

  void close() { session_.reset(); }
  Session* session() { return session_ ? &*session_ : nullptr; }
  const Session* session() const { return session_ ? &*session_ : nullptr; }
  const std::shared_ptr<const LoadedScene>& scene() const { return scene_; }

 private:
  static constexpr double kIdle = -1;

  void compile(const RenderRequest& request, const RenderSettings& settings);
  void apply_motion(const SceneEdits& edits);   ///< time and camera
  void apply_changes(const SceneEdits& edits);  ///< all others

  std::optional<Session> session_;
  std::shared_ptr<const LoadedScene> scene_;
  std::vector<Index> movable_;
  std::string variant_;       ///< material variant of the compiled scene
  uint64_t applied_ = 0;      ///< newest applied edit
  uint64_t environment_ = 0;  ///< edit of the environment at compilation
  std::atomic<double> compiling_since_s_ = kIdle;
  std::atomic<double> updating_since_s_ = kIdle;
};

/// Picks a point of the image, (0, 0) its top left corner and (1, 1) the opposite one.
PickResult pick(const Session& session, const Vec2& point);

}  // namespace relume::viewer
