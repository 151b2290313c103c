// The work of every frame of an interface except input and drawing.
#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <utility>

#include "viewer/model/monitor.h"
#include "viewer/model/state.h"

namespace relume::viewer {

/// Takes frames and notices of the rendering thread, follows files and animation, and posts requests. A frame of the
/// interface calls begin_frame(), advance() and post(), in this order.
class ViewLoop {
 public:
  /// Both outlive this object.
  ViewLoop(State& state, RenderThread& renderer) : state_(state), renderer_(renderer) {}

  /// Sets the time, and takes frames and notices.
  void begin_frame(double now_s);
  /// Advances reloads, picks, animation and camera path.
  void advance();
  /// Posts the state as a request if it has changed.
  void post();

  Monitor& monitor() { return monitor_; }
  const Monitor& monitor() const { return monitor_; }
  uint64_t version() const { return version_; }              ///< of the newest request
  double newest_frame_s() const { return newest_frame_s_; }  ///< time at which side A's newest frame was received
  const std::string& first_problem() const { return first_problem_; }
  const std::string& failed_task() const { return failed_task_; }  ///< error of the first failed task
  const std::string& device_loss() const { return device_loss_; }  ///< error of a GPU that is lost

  /// Sets the time before the first frame.
  void start(double now_s) { newest_frame_s_ = last_s_ = now_s; }
  void take_notices();

 private:
  void take_frames();

  State& state_;
  RenderThread& renderer_;
  Monitor monitor_;
  double last_s_ = 0;
  double passed_s_ = 0;   ///< since the previous frame of the interface
  double numbers_s_ = 0;  ///< time at which the displayed rates last changed
  uint64_t version_ = 0;
  uint64_t image_version_ = 0;
  uint64_t camera_version_ = 0;
  uint64_t release_version_ = 0;  ///< request that last returned to the scene's camera
  double newest_frame_s_ = 0;
  std::deque<std::pair<uint64_t, uint64_t>> camera_moves_;  ///< request, and the newest frame when it was posted
  std::string first_problem_;
  std::string failed_task_;
  std::string device_loss_;
};

}  // namespace relume::viewer
