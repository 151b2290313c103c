// Renders on a thread of its own, at a lower priority than the interface. Requests never wait for it: the newest one
// counts, and what the interface shows is the newest complete frame.
#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>
#include <vector>

#include "viewer/request.h"
#include "viewer/resolution.h"
#include "viewer/session_slot.h"

namespace relume::viewer {

class RenderThread {
 public:
  RenderThread();
  ~RenderThread();
  RenderThread(const RenderThread&) = delete;
  RenderThread& operator=(const RenderThread&) = delete;

  /// Ends rendering, after the tasks that were asked for. Nothing is rendered after that.
  void stop();

  /// Calls `hook` on the rendering thread after each frame. Call before the first request.
  void on_frame(std::function<void()> hook) { frame_hook_ = std::move(hook); }

  /// Replaces the request. A frame that only refines an image that is no longer wanted is abandoned, and so is the
  /// large one at rest; the first frame after a change never is, so that an image follows every stream of changes. Only
  /// its preparation ends early. After a rest it is small, to show at once.
  void post(RenderRequest request);

  /// Done with side A's session and the scene that it renders, which need not be the one of the newest request.
  using Task = std::function<void(const Session&, const LoadedScene&)>;
  /// Asks for something to be done between two frames, once there is an image: it may take as long as it likes.
  void post_task(Task task);

  /// When the compilation in progress began, of a new scene or again after an edit, by now_s(); std::nullopt without
  /// one.
  std::optional<double> compiling_since_s() const;

  /// The newest frame of a side; nullptr before the first.
  std::shared_ptr<const ViewerFrame> frame(int side) const;

  /// Serial of side A's first frame that follows the request of this version or a later one; 0 before there is one.
  /// Goes back some hundred frames.
  uint64_t first_frame_following(uint64_t version) const;

  /// What happened since the last call.
  std::vector<Notice> take_notices();
  void add_notice(Notice notice);

 private:
  /// Whether a side has met --error. Kept until its frames begin anew: the error is looked at in few of them, and these
  /// need not be the same on both sides.
  struct ErrorVerdict {
    float limit = 0;
    uint32_t frames = 0;  ///< since the change, as of the last look
    bool met = false;
  };

  void run(const std::stop_token& stop);
  bool wait_for_work(const std::stop_token& stop);
  void run_tasks();
  void render_round(const std::stop_token& stop);
  bool render_side(const std::stop_token& stop, int side, const IVec2& size, bool rest);
  void close_second_side();
  bool ready_for_tasks() const;
  bool tasks_wait() const;
  void finish_tasks();  ///< at the end: a task that is not done is a notice
  void publish(int side, double seconds, uint64_t rays_before, const std::vector<PassTime>& passes_before);
  void note_size(const IVec2& size, double seconds, bool rest);
  IVec2 choose_size(bool rest) const;
  bool at_rest() const;                               ///< nothing has changed for a moment: images may take their time
  bool has_final_size(const Session& session) const;  ///< no larger image follows at rest
  bool goal_reached(int side);
  bool error_reached(int side);

  mutable std::mutex mutex_;  ///< guards what follows; held for moments only
  std::condition_variable_any wake_;
  RenderRequest wanted_;
  std::deque<Task> tasks_;
  std::array<std::shared_ptr<const ViewerFrame>, kSides> frames_;
  std::deque<std::pair<uint64_t, uint64_t>> followed_;  ///< request and serial of side A's latest frames
  std::vector<Notice> notices_;
  std::stop_source refinement_;  ///< of the frame in progress, if it may be abandoned
  std::stop_source hurry_;       ///< of the frame in progress: its preparation ends early

  std::function<void()> frame_hook_;  ///< set before there are frames

  // Of the rendering thread alone.
  RenderRequest request_;
  std::array<SessionSlot, kSides> slots_;
  std::array<uint64_t, kSides> serials_{};
  ResolutionControl resolution_;
  uint64_t refused_version_ = 0;  ///< a request that ended in an error; not tried again
  double changed_s_ = 0;          ///< when the request last changed
  bool rested_ = false;           ///< the latest frame, complete or not, was one at rest
  bool goal_reached_ = false;
  std::array<ErrorVerdict, kSides> verdicts_;
  std::jthread thread_;  ///< last: it ends before anything that it uses
};

}  // namespace relume::viewer
