// Viewer scripts for tests and tours, one step per line (listed in docs/viewer.md).
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/vec.h"

namespace relume::viewer {

struct ScriptStep {
  int line = 0;
  std::string verb;
  std::vector<std::string> words;  ///< after the verb; for some verbs, the last one is the rest of the line
};

/// Throws Error naming `place` and line for an unknown verb or missing words. '#' starts a comment.
std::vector<ScriptStep> parse_script(std::string_view text, const std::string& place);

/// Parses a word of a step. Throws Error if it is not a finite number.
float number_in(const std::string& text);

/// Keys and mouse held by a script.
struct ScriptedInput {
  std::vector<int> keys;  ///< GLFW codes of the held keys
  bool mouse = false;     ///< whether the script controls the mouse
  Vec2 point{0.5f};       ///< of the image, (0, 0) its top left corner
  bool left = false;
  float wheel = 0;
};

/// Parses "w", "shift+f12", "ctrl+1" to GLFW key codes. Throws Error for an unknown name.
std::vector<int> parse_keys(const std::string& text, const std::string& place);

/// The script player's interface to the viewer.
struct ScriptTarget {
  std::function<uint64_t()> frames;   ///< serial of the displayed frame; 0 before the first
  std::function<uint64_t()> request;  ///< version of the newest request to the rendering thread
  /// Serial of the first frame that follows a request of this version or a later one; 0 before there is one.
  std::function<uint64_t(uint64_t)> first_frame_following;
  std::function<double()> now_s;
  std::function<bool()> loading;
  /// Executes an instantaneous step. Throws Error.
  std::function<void(const ScriptStep&)> act;
};

/// Executes the steps, some of which take time.
class ScriptPlayer {
 public:
  ScriptPlayer() = default;
  ScriptPlayer(std::vector<ScriptStep> steps, std::string place) : steps_(std::move(steps)), place_(std::move(place)) {}

  bool done() const { return next_ >= steps_.size(); }

  /// Called once per frame of the interface. Throws Error naming the line of a step that fails, or during which no
  /// frame arrived for five minutes, the limit for compiling large scenes.
  void update(const ScriptTarget& target);

  const ScriptedInput& input() const { return input_; }

 private:
  /// Returns whether the step is complete; `tick_` counts its calls.
  bool perform(const ScriptStep& step, const ScriptTarget& target);
  bool perform_mouse(const ScriptStep& step);
  bool wait_for_frames(uint64_t count, const ScriptTarget& target);

  std::vector<ScriptStep> steps_;
  std::string place_;
  size_t next_ = 0;
  int tick_ = 0;
  uint64_t first_frame_ = 0;  ///< displayed frame at the start of the step
  uint64_t seen_frame_ = 0;
  uint64_t request_ = 0;    ///< request that `frames` waits for: the newest at its start
  uint64_t following_ = 0;  ///< first frame that follows it; 0 while unknown
  double begun_s_ = 0;
  double progress_s_ = 0;  ///< time of the step's start or of the latest frame
  ScriptedInput input_;
};

}  // namespace relume::viewer
