// Scripted use of the viewer, for tests and tours: a line a step (docs/viewer.md lists them).
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
  std::vector<std::string> words;  ///< after the verb; the last one takes the rest of the line where the verb says so
};

/// Throws Error naming `place` and line for a verb that does not exist or lacks words. '#' begins a comment.
std::vector<ScriptStep> parse_script(std::string_view text, const std::string& place);

/// A word of a step. Throws Error if it is not a finite number.
float number_in(const std::string& text);

/// Keys and mouse as a script holds them.
struct ScriptedInput {
  std::vector<int> keys;  ///< GLFW's names of the keys that are down
  bool mouse = false;     ///< the script has the mouse
  Vec2 point{0.5f};       ///< of the image, (0, 0) its top left corner
  bool left = false;
  float wheel = 0;
};

/// "w", "shift+f12", "ctrl+1": GLFW's keys. Throws Error for a name that no key has.
std::vector<int> parse_keys(const std::string& text, const std::string& place);

/// What steps do to the viewer, as the player sees it.
struct ScriptTarget {
  std::function<uint64_t()> frames;   ///< serial of the frame that is shown; 0 before the first
  std::function<uint64_t()> request;  ///< version of the newest request to the rendering thread
  /// Serial of the first frame that follows a request of this version or a later one; 0 before there is one.
  std::function<uint64_t(uint64_t)> first_frame_following;
  std::function<double()> now_s;
  std::function<bool()> loading;
  /// Does a step that is over at once. Throws Error.
  std::function<void(const ScriptStep&)> act;
};

/// Goes through the steps, a few of which take time.
class ScriptPlayer {
 public:
  ScriptPlayer() = default;
  ScriptPlayer(std::vector<ScriptStep> steps, std::string place) : steps_(std::move(steps)), place_(std::move(place)) {}

  bool done() const { return next_ >= steps_.size(); }

  /// Called once a frame of the interface. Throws Error naming the line of a step that fails, or during which no frame
  /// came for five minutes, in which large scenes are compiled.
  void update(const ScriptTarget& target);

  const ScriptedInput& input() const { return input_; }

 private:
  /// Whether the step is over; `tick_` counts its calls.
  bool perform(const ScriptStep& step, const ScriptTarget& target);
  bool perform_mouse(const ScriptStep& step);
  bool wait_for_frames(uint64_t count, const ScriptTarget& target);

  std::vector<ScriptStep> steps_;
  std::string place_;
  size_t next_ = 0;
  int tick_ = 0;
  uint64_t first_frame_ = 0;  ///< shown when the step began
  uint64_t seen_frame_ = 0;
  uint64_t request_ = 0;    ///< that `frames` waits for: the newest when it began
  uint64_t following_ = 0;  ///< first frame that follows it; 0 while unknown
  double begun_s_ = 0;
  double progress_s_ = 0;  ///< when the step began or a frame came last
  ScriptedInput input_;
};

}  // namespace relume::viewer
