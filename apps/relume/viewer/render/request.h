// Messages between the interface and rendering threads: requests, frames and notices.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "frame/device_display.h"
#include "render/aov.h"
#include "render/session.h"
#include "render/settings.h"
#include "scene/scene.h"

namespace relume::viewer {

/// A loaded scene, immutable and shared by both threads.
struct LoadedScene {
  std::string name;  ///< file or built-in scene, as given by the user
  Scene scene;
  double load_s = 0;  ///< loading time
  /// Start of loading: files written later may have been read before the write.
  std::filesystem::file_time_type read_from = std::filesystem::file_time_type::max();
};

/// A value that overrides the scene's, and the version that set it. Versions count all edits of a scene.
template <typename T>
struct Edit {
  T value{};
  uint64_t version = 0;  ///< 0: never set
};

/// All differences from the loaded scene. A session applies edits newer than its latest, and a new session applies all.
struct SceneEdits {
  Edit<std::optional<CameraPose>> camera;  ///< std::nullopt: the scene's
  Edit<float> time_s;
  Edit<std::shared_ptr<const Environment>> environment;
  std::map<Index, Edit<Transform>> nodes;
  std::map<Index, Edit<PunctualLight>> lights;
  std::map<Index, Edit<Material>> materials;
  std::vector<Index> movable;  ///< nodes in `nodes` that carry meshes
  uint64_t version = 0;        ///< newest version of all edits
};

/// Adaptation of the resolution to the frame rate.
struct ResolutionPolicy {
  bool hold_rate = true;      ///< scale the resolution until `target_hz` is met
  bool upscale = false;       ///< before that, trace a path in one of four pixels per frame
  float target_hz = 30;       ///< rendered frames per second
  bool full_at_rest = true;   ///< full resolution after a moment without changes
  float rest_after_s = 0.4f;  ///< length of that moment
  float preparation_s = 1;    ///< maximum per frame, continued in later frames; 0: unlimited
};

inline constexpr int kSides = 2;  ///< A and B

/// The user's request to the rendering thread. The newest one counts.
struct RenderRequest {
  uint64_t version = 0;
  uint64_t image_version = 0;  ///< changes only with the image; other changes do not interrupt the rest
  std::shared_ptr<const LoadedScene> scene;
  SceneEdits edits;
  std::array<AllSettings, kSides> settings;
  bool split = false;  ///< render B too
  bool paused = false;
  ResolutionPolicy resolution_policy;
  std::string buffer;  ///< inspected buffer; empty: the image
};

/// A complete frame, with all data that the interface shows.
struct ViewerFrame {
  uint64_t serial = 0;           ///< count of frames of this side
  uint64_t request_version = 0;  ///< request that the frame follows
  std::shared_ptr<const LoadedScene> scene;
  int width = 0;
  int height = 0;
  int full_width = 0;                         ///< without scaling
  int upscale = 1;                            ///< edge of the blocks of pixels with one path per frame
  std::vector<Rgb> radiance;                  ///< empty if `device_image` has it
  std::shared_ptr<DeviceImage> device_image;  ///< nullptr: the image is in `radiance`
  std::string buffer;                         ///< name of the inspected buffer; empty: the image
  std::string channels;                       ///< its channels, one letter each, at most three
  std::vector<Rgb> values;                    ///< its values; missing channels are 0
  Vec2 value_range{0, 1};                     ///< 1st and 99th percentile of its finite values
  float metered_exposure = 0;                 ///< auto_exposure() of the radiance
  bool in_studio = false;                     ///< Session::in_studio()
  double samples = 0;                         ///< Session::kept_samples()
  double seconds = 0;                         ///< frame time
  double rays_per_s = 0;                      ///< of this frame
  bool reached_goal = false;                  ///< whether --spp, --time or --error has been reached
  std::vector<PassTime> passes;
  CameraPose camera;
  float time_s = 0;
  Statistics statistics;
  std::vector<AovLayer> buffers;  ///< buffers available for inspection
  std::vector<std::string> notes;
};

/// Result of picking a point of the image.
struct PickResult {
  const LoadedScene* scene = nullptr;  ///< scene of the image
  bool hit = false;
  Index node = kNone;
  Vec3 position{0};
};

/// A message to the user.
struct Notice {
  bool problem = false;
  std::string text;
  std::shared_ptr<const LoadedScene> refused_scene = nullptr;  ///< scene that could not be compiled
  bool failed_task = false;                                    ///< for example, an image could not be written
  bool device_lost = false;                                    ///< nothing more can be rendered
};

}  // namespace relume::viewer
