// The viewer: state, rendering thread, window and panels, and the loop that keeps them together.
#pragma once

#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "viewer/monitor.h"
#include "viewer/script.h"
#include "viewer/state.h"
#include "viewer/view_job.h"
#include "viewer/viewport.h"
#include "viewer/window.h"

namespace relume::viewer {

class App {
 public:
  App(const cli::ViewOptions& options, const AllSettings& settings, bool fixed_size, ScriptPlayer script,
      std::shared_ptr<const LoadedScene> scene, std::shared_ptr<const OcioView> ocio);

  /// Runs until the window is closed, or the script and the wanted frames are through. Throws Error if the first scene
  /// cannot be shown, or a step of the script fails.
  void run();

  /// Whether a scene is still being loaded, which will not be shown any more.
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
  double numbers_s_ = 0;  ///< when the shown rates last changed
  uint64_t version_ = 0;
  uint64_t image_version_ = 0;
  uint64_t camera_version_ = 0;
  uint64_t release_version_ = 0;                            ///< request with which the scene's camera came back last
  double newest_frame_s_ = 0;                               ///< when the newest frame was taken
  std::deque<std::pair<uint64_t, uint64_t>> camera_moves_;  ///< request, and the newest frame when it was posted
  std::string first_problem_;
  std::string failed_task_;  ///< why the first task failed
  std::string screenshot_;   ///< to be taken after this frame
  RenderThread renderer_;    ///< last: it ends first
};

}  // namespace relume::viewer
