// The window, its OpenGL context and Dear ImGui.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

struct GLFWwindow;

namespace relume::viewer {

class Window {
 public:
  /// Throws Error without a display or OpenGL 3.3. `visible` false: draws into a hidden window.
  Window(int width, int height, const std::string& title, bool visible);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Throws Error without a display. Call from the thread that opens the window later.
  static void require_display();

  bool should_close() const;
  void set_title(const std::string& title);

  /// Waits until the next frame of the interface is due, handles events and begins it. `change_input` runs between the
  /// system's input and the frame, and may override the input.
  void begin_frame(double interval_s, const std::function<void()>& change_input);
  /// Starts the next frame early, to show new content, but at most once per three intervals. Callable from any
  /// thread.
  void hurry();
  /// Draws if the interface or `content` (a version of the textures' content) has changed. With software rendering,
  /// skipping leaves the processor to the renderer.
  void end_frame(uint64_t content);
  /// Smoothed drawing time.
  double drawing_s() const { return drawing_s_; }

  /// Writes the last drawn frame as PNG or another format of write_image(). Throws Error.
  void save(const std::filesystem::path& file);

  /// Files dropped on the window since the last call.
  std::vector<std::string> take_dropped_files();

  /// Side of a pixel of the interface in pixels of the display.
  float content_scale() const;

 private:
  GLFWwindow* window_ = nullptr;
  std::vector<std::string> dropped_;
  double next_frame_s_ = 0;
  double hurried_s_ = 0;  ///< time at which a frame last started early
  std::atomic<bool> hurries_ = false;
  double drawing_s_ = 0;
  uint64_t drawn_ = 0;  ///< fingerprint of the displayed content; 0: must be drawn
};

}  // namespace relume::viewer
