// The viewer: state, rendering thread, window, panels, and the main loop.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "viewer/model/monitor.h"
#include "viewer/model/script.h"
#include "viewer/model/state.h"
#include "viewer/view_job.h"
#include "viewer/viewport.h"
#include "viewer/window.h"

namespace relume::viewer {

class App {
 public:
  App(const cli::ViewOptions& options, const AllSettings& settings, bool fixed_size, ScriptPlayer script,
      std::shared_ptr<const LoadedScene> scene, OcioDisplay ocio);

  /// Runs until the window is closed, or until the script and the requested frames are complete. Throws Error if the
  /// first scene cannot be shown, a step of the script fails, or a GPU is lost.
  void run();

  /// Whether a scene is still loading that will not be shown.
  bool loading() const { return state_.loading.valid() || !state_.superseded.empty(); }

 private:
  void frame();
  void take_input();
  void take_frames();
  void take_notices();
  void post();
  void draw();
  void draw_tabs();
  void act(const ScriptStep& step);
  void act_on_scene(const ScriptStep& step);
  bool finished() const;
  std::string report() const;
  void finish();

  const cli::ViewOptions& options_;
  bool smoke_;
  Window window_;
  State state_;
  Monitor monitor_;
  ScriptPlayer script_;
  Viewport viewport_;
  double last_s_ = 0;
  double numbers_s_ = 0;  ///< time at which the displayed rates last changed
  uint64_t version_ = 0;
  uint64_t image_version_ = 0;
  uint64_t camera_version_ = 0;
  uint64_t release_version_ = 0;                            ///< request that last returned to the scene's camera
  double newest_frame_s_ = 0;                               ///< time at which the newest frame was received
  std::deque<std::pair<uint64_t, uint64_t>> camera_moves_;  ///< request, and the newest frame when it was posted
  std::string first_problem_;
  std::string failed_task_;  ///< error of the first failed task
  std::string device_loss_;  ///< error of a GPU that is lost
  std::string screenshot_;   ///< file for a screenshot after this frame
  RenderThread renderer_;    ///< last member: its thread ends first
};

}  // namespace relume::viewer
