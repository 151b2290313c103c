// The viewer: state, rendering thread, window, panels, and the main loop.
#pragma once

#include <memory>
#include <string>

#include "viewer/model/script.h"
#include "viewer/model/state.h"
#include "viewer/model/view_loop.h"
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
  ScriptPlayer script_;
  Viewport viewport_;
  ViewLoop loop_;
  std::string screenshot_;  ///< file for a screenshot after this frame
  RenderThread renderer_;   ///< last member: its thread ends first
};

}  // namespace relume::viewer
