// One side of the viewer: a session that follows requests.
#pragma once

#include <atomic>
#include <memory>
#include <optional>
#include <vector>

#include "viewer/request.h"

namespace relume::viewer {

class SessionSlot {
 public:
  /// Applies the settings and edits that `request` has for this side, at `size` pixels. Compiles the scene again only
  /// where the session cannot apply an edit. A change starts a new image. Throws Error; an existing session then stays
  /// as it was.
  void update(const RenderRequest& request, int side, const IVec2& size);

  /// When the compilation in progress began, by now_s(); std::nullopt without one. On any thread.
  std::optional<double> compiling_since_s() const;

  void close() { session_.reset(); }
  Session* session() { return session_ ? &*session_ : nullptr; }
  const Session* session() const { return session_ ? &*session_ : nullptr; }
  const std::shared_ptr<const LoadedScene>& scene() const { return scene_; }

 private:
  static constexpr double kNotCompiling = -1;

  void compile(const RenderRequest& request, const RenderSettings& settings);
  void apply(const SceneEdits& edits);

  std::optional<Session> session_;
  std::shared_ptr<const LoadedScene> scene_;
  std::vector<Index> movable_;
  std::string variant_;       ///< that it was compiled with
  uint64_t applied_ = 0;      ///< newest edit that the session has taken on
  uint64_t environment_ = 0;  ///< edit of the environment that it was compiled with
  std::atomic<double> compiling_since_s_ = kNotCompiling;
};

/// What lies under a point of the image, (0, 0) its top left corner and (1, 1) the opposite one.
PickResult pick(const Session& session, const Vec2& point);

}  // namespace relume::viewer
