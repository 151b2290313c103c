// What passes between the interface's thread and the rendering thread: requests one way, frames and notices the other.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/aov.h"
#include "render/session.h"
#include "render/settings.h"
#include "scene/scene.h"

namespace relume::viewer {

/// A scene as it was loaded. Shared by both threads, and never changed.
struct LoadedScene {
  std::string name;  ///< file or built-in scene, as the user gave it
  Scene scene;
  double load_s = 0;  ///< that reading it took
  /// When reading began: files that were written later may have been read before that.
  std::filesystem::file_time_type read_from = std::filesystem::file_time_type::max();
};

/// A value that replaces what the scene says, and when it was last set: versions count up over all edits of a scene.
template <typename T>
struct Edit {
  T value{};
  uint64_t version = 0;  ///< 0: never set
};

/// Everything that differs from the scene as it was loaded. A session takes on what is newer than what it has seen, and
/// a new session all of it.
struct SceneEdits {
  Edit<std::optional<CameraPose>> camera;  ///< std::nullopt: that of the scene
  Edit<float> time_s;
  Edit<std::shared_ptr<const Environment>> environment;
  std::map<Index, Edit<Transform>> nodes;
  std::map<Index, Edit<PunctualLight>> lights;
  std::map<Index, Edit<Material>> materials;
  std::vector<Index> movable;  ///< nodes that `nodes` moves and that carry meshes
  uint64_t version = 0;        ///< the newest of all
};

/// How the resolution follows the frame rate.
struct ResolutionPolicy {
  bool hold_rate = true;      ///< scale the resolution until `target_hz` is met
  float target_hz = 10;       ///< rendered frames a second
  bool full_at_rest = true;   ///< full resolution when nothing has changed for a moment
  float rest_after_s = 0.4f;  ///< that moment
  float preparation_s = 1;    ///< of a frame, at most; later frames continue it; 0: any
};

inline constexpr int kSides = 2;  ///< A and B

/// What the user wants to see. The newest one counts.
struct RenderRequest {
  uint64_t version = 0;
  uint64_t image_version = 0;  ///< changes only where the image does; what else changes disturbs no rest
  std::shared_ptr<const LoadedScene> scene;
  SceneEdits edits;
  std::array<AllSettings, kSides> settings;
  bool split = false;  ///< render B too
  bool paused = false;
  ResolutionPolicy resolution_policy;
  std::string buffer;  ///< to inspect; empty: the image
};

/// A complete frame, with all that the interface shows of it.
struct ViewerFrame {
  uint64_t serial = 0;           ///< counts the frames of this side
  uint64_t request_version = 0;  ///< of the request that it follows
  std::shared_ptr<const LoadedScene> scene;
  int width = 0;
  int height = 0;
  int full_width = 0;  ///< without scaling
  std::vector<Rgb> radiance;
  std::string buffer;          ///< name of the inspected one; empty: the image
  std::string channels;        ///< its channels, one letter each, at most three
  std::vector<Rgb> values;     ///< its values; missing channels are 0
  Vec2 value_range{0, 1};      ///< 1st and 99th percentile of its finite values
  float metered_exposure = 0;  ///< auto_exposure() of the radiance
  bool in_studio = false;      ///< Session::in_studio()
  double samples = 0;          ///< Session::kept_samples()
  double seconds = 0;          ///< that the frame took
  double rays_per_s = 0;       ///< of this frame
  bool reached_goal = false;   ///< --spp, --time or --error asks for no more
  std::vector<PassTime> passes;
  CameraPose camera;
  float time_s = 0;
  Statistics statistics;
  std::vector<AovLayer> buffers;  ///< that can be inspected
  std::vector<std::string> notes;
};

/// What lies under a point of the image.
struct PickResult {
  const LoadedScene* scene = nullptr;  ///< that the image shows
  bool hit = false;
  Index node = kNone;
  Vec3 position{0};
};

/// Something to tell the user.
struct Notice {
  bool problem = false;
  std::string text;
  std::shared_ptr<const LoadedScene> refused_scene = nullptr;  ///< this scene could not be compiled
  bool failed_task = false;                                    ///< an image could not be written, for instance
};

}  // namespace relume::viewer
