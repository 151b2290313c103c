// Bookmarks and camera paths.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <glm/gtc/quaternion.hpp>

#include "core/vec.h"

namespace relume::viewer {

struct Viewpoint {
  Vec3 eye{0};
  glm::quat rotation{1, 0, 0, 0};  ///< of a camera facing -Z
  float fov_y_rad = 0.8f;
};

struct Bookmark {
  std::string name;
  Viewpoint view;
};

/// Reads the output of write_bookmarks(); empty if the file does not exist. Throws Error for anything else.
std::vector<Bookmark> read_bookmarks(const std::filesystem::path& file);
void write_bookmarks(const std::filesystem::path& file, const std::vector<Bookmark>& bookmarks);

struct PathKey {
  float time_s = 0;
  Vec3 eye{0};
  glm::quat rotation{1, 0, 0, 0};
};

/// Key frames of a camera, interpolated linearly, as in relume JSON.
class CameraPath {
 public:
  /// Adds a key. Ignores one that is not later than the last.
  void add(const PathKey& key);
  void clear() { keys_.clear(); }
  /// The camera at a time; clamped to the first and last key.
  PathKey at(float time_s) const;
  float duration_s() const { return keys_.empty() ? 0.0f : keys_.back().time_s; }
  const std::vector<PathKey>& keys() const { return keys_; }

 private:
  std::vector<PathKey> keys_;
};

}  // namespace relume::viewer
