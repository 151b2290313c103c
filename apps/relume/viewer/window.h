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
  /// Throws Error where there is no display or no OpenGL 3.3. `visible` false: draws, but shows nothing.
  Window(int width, int height, const std::string& title, bool visible);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Throws Error where there is no display. For the thread that opens the window later.
  static void require_display();

  bool should_close() const;
  void set_title(const std::string& title);

  /// Waits until the next frame of the interface is due, handles events and begins it. `change_input` runs between the
  /// system's input and the frame, and may replace it.
  void begin_frame(double interval_s, const std::function<void()>& change_input);
  /// Lets the next frame begin before it is due, as there is something new to show; not more often than every third
  /// frame would. For any thread.
  void hurry();
  /// Draws what has changed: nothing if the interface is as it was and `content` (a version of what textures hold) too.
  /// Where the processor draws, that leaves it to the renderer.
  void end_frame(uint64_t content);
  /// What drawing costs, smoothed.
  double drawing_s() const { return drawing_s_; }

  /// What the last frame drew, as PNG or another format of write_image(). Throws Error.
  void save(const std::filesystem::path& file);

  /// Files dropped on the window since the last call.
  std::vector<std::string> take_dropped_files();

  /// Side of a pixel of the interface in pixels of the display.
  float content_scale() const;

 private:
  GLFWwindow* window_ = nullptr;
  std::vector<std::string> dropped_;
  double next_frame_s_ = 0;
  double hurried_s_ = 0;  ///< when a frame last began early
  std::atomic<bool> hurries_ = false;
  double drawing_s_ = 0;
  uint64_t drawn_ = 0;  ///< fingerprint of what the window shows; 0: has to be drawn
};

}  // namespace relume::viewer
