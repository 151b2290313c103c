// Renders on a separate thread, at a lower priority than the interface. Requests never wait for it: only the newest one
// counts, and the interface shows the newest complete frame.
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

#include "viewer/render/request.h"
#include "viewer/render/resolution.h"
#include "viewer/render/session_slot.h"

namespace relume::viewer {

class RenderThread {
 public:
  RenderThread();
  ~RenderThread();
  RenderThread(const RenderThread&) = delete;
  RenderThread& operator=(const RenderThread&) = delete;

  /// Stops rendering after the pending tasks.
  void stop();

  /// Calls `hook` on the rendering thread after each frame. Call before the first request.
  void on_frame(std::function<void()> hook) { frame_hook_ = std::move(hook); }

  /// Whether images of a GPU reach frames as ViewerFrame::device_image where possible. Off by default. Call before the
  /// first request.
  void keep_images_on_device(bool keep) { keeps_images_on_device_ = keep; }

  /// Replaces the request. A frame that only refines an outdated image is cancelled, and so is the large one at rest.
  /// The first frame after a change is finished, so that images follow a stream of changes; only its preparation ends
  /// early. After a rest it is small, for low latency.
  void post(RenderRequest request);

  /// Receives side A's session and the scene that it renders, which may be older than the newest request.
  using Task = std::function<void(const Session&, const LoadedScene&)>;
  /// Runs a task between two frames, once there is an image. It may take any time.
  void post_task(Task task);

  /// Start of the compilation in progress, of a new scene or after an edit, by now_s(); std::nullopt if there is none.
  std::optional<double> compiling_since_s() const;
  /// Start of applying edits and settings, compilation included.
  std::optional<double> updating_since_s() const;

  /// The newest frame of a side; nullptr before the first.
  std::shared_ptr<const ViewerFrame> frame(int side) const;

  /// Serial of side A's first frame that follows the request of this version or a later one; 0 before there is one.
  /// Covers the last few hundred frames.
  uint64_t first_frame_following(uint64_t version) const;

  /// Notices since the last call.
  std::vector<Notice> take_notices();
  void add_notice(Notice notice);

 private:
  /// Whether a side has met --error. Kept until its image restarts, because the error is only checked in some frames,
  /// which may differ between the sides.
  struct ErrorVerdict {
    float limit = 0;
    uint32_t frames = 0;  ///< frames since the change at the last check
    bool met = false;
  };

  void run(const std::stop_token& stop);
  bool wait_for_work(const std::stop_token& stop);
  void run_tasks();
  void render_round(const std::stop_token& stop);
  bool render_side(const std::stop_token& stop, int side, const FrameScale& scale, bool rest);
  void close_second_side();
  bool ready_for_tasks() const;
  bool tasks_wait() const;
  bool has_lost_device() const;
  void finish_tasks();  ///< at the end: reports unfinished tasks
  void take_image(Session& session, ViewerFrame& frame) const;
  void publish(int side, double seconds, uint64_t rays_before, const std::vector<PassTime>& passes_before);
  void note_size(const IVec2& size, double seconds, bool rest);
  FrameScale choose_scale(bool rest);
  bool may_upscale() const;  ///< whether the policy and both sides' techniques permit upscaling
  bool at_rest() const;      ///< whether nothing has changed for a moment, so that images may take longer
  bool has_final_size(const Session& session) const;  ///< no larger image follows at rest
  bool goal_reached(int side);
  bool error_reached(int side);

  mutable std::mutex mutex_;  ///< guards the members below; held briefly
  std::condition_variable_any wake_;
  RenderRequest wanted_;
  std::deque<Task> tasks_;
  std::array<std::shared_ptr<const ViewerFrame>, kSides> frames_;
  std::deque<std::pair<uint64_t, uint64_t>> followed_;  ///< request and serial of side A's latest frames
  std::vector<Notice> notices_;
  std::stop_source refinement_;  ///< of the frame in progress, if it may be cancelled
  std::stop_source hurry_;       ///< of the frame in progress: its preparation ends early

  std::function<void()> frame_hook_;     ///< set before the first frame
  bool keeps_images_on_device_ = false;  ///< the same

  // Used only by the rendering thread.
  RenderRequest request_;
  std::array<SessionSlot, kSides> slots_;
  std::array<uint64_t, kSides> serials_{};
  ResolutionControl resolution_;
  uint64_t refused_version_ = 0;  ///< request that ended in an error; not retried
  double changed_s_ = 0;          ///< when the request last changed
  bool rested_ = false;           ///< whether the latest frame, complete or cancelled, was one at rest
  bool goal_reached_ = false;
  std::array<ErrorVerdict, kSides> verdicts_;
  std::jthread thread_;  ///< last: it must end before the other members
};

}  // namespace relume::viewer
