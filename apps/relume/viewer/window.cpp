#include "viewer/window.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <fmt/format.h>
#include <imgui/backends/imgui_impl_glfw.h>
#include <imgui/backends/imgui_impl_opengl3.h>
#include <imgui/imgui.h>

#include "core/srgb.h"
#include "relume/error.h"
#include "relume/image_io.h"
#include "viewer/panels/theme.h"
#include "viewer/render/gl.h"

namespace relume::viewer {
namespace {

std::string glfw_problem() {
  const char* text = nullptr;
  glfwGetError(&text);
  return text ? text : "no reason given";
}

/// Converts OpenGL's pixels, bottom row first, to an image.
Image image_from_pixels(const std::vector<unsigned char>& rgba, int width, int height) {
  Image image(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const unsigned char* p =
          &rgba[4 * (static_cast<size_t>(height - 1 - y) * static_cast<size_t>(width) + static_cast<size_t>(x))];
      const auto linear = [](unsigned char byte) { return linear_from_srgb(static_cast<float>(byte) / 255.0f); };
      image.at(x, y) = {linear(p[0]), linear(p[1]), linear(p[2])};
    }
  }
  return image;
}

/// Mixes bytes into a hash, eight at a time (FNV-1a's prime).
uint64_t mix(uint64_t hash, const void* data, size_t size) {
  const auto* bytes = static_cast<const unsigned char*>(data);
  for (; size >= 8; bytes += 8, size -= 8) {
    uint64_t word = 0;
    std::memcpy(&word, bytes, 8);
    hash = (hash ^ word) * 1099511628211ull;
    hash ^= hash >> 29;
  }
  for (; size > 0; ++bytes, --size) hash = (hash ^ *bytes) * 1099511628211ull;
  return hash;
}

/// Hash of the interface's draw data and `content`.
uint64_t fingerprint(const ImDrawData& data, uint64_t content) {
  uint64_t hash = mix(14695981039346656037ull, &content, sizeof content);
  hash = mix(hash, &data.DisplaySize, sizeof data.DisplaySize);
  for (int i = 0; i < data.CmdListsCount; ++i) {
    const ImDrawList& list = *data.CmdLists[i];
    hash = mix(hash, list.VtxBuffer.Data, static_cast<size_t>(list.VtxBuffer.Size) * sizeof(ImDrawVert));
    hash = mix(hash, list.IdxBuffer.Data, static_cast<size_t>(list.IdxBuffer.Size) * sizeof(ImDrawIdx));
    for (const ImDrawCmd& command : list.CmdBuffer) {
      hash = mix(hash, &command.ClipRect, sizeof command.ClipRect);
      hash = mix(hash, &command.TextureId, sizeof command.TextureId);
      hash = mix(hash, &command.ElemCount, sizeof command.ElemCount);
    }
  }
  return hash == 0 ? 1 : hash;
}

}  // namespace

void Window::require_display() {
#ifdef GLFW_PLATFORM  // GLFW 3.4: without Wayland, requesting it prints an error
  if (std::getenv("WAYLAND_DISPLAY") == nullptr) glfwInitHint(GLFW_PLATFORM, GLFW_PLATFORM_X11);
#endif
  if (glfwInit() == GLFW_TRUE) return;
  throw Error(
      fmt::format("cannot open a window ({}); relume view needs a display, such as X11 or `xvfb-run`", glfw_problem()));
}

Window::Window(int width, int height, const std::string& title, bool visible) {
  require_display();
  glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 3);
  glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 3);
  glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
  glfwWindowHint(GLFW_OPENGL_FORWARD_COMPAT, GLFW_TRUE);
  glfwWindowHint(GLFW_VISIBLE, visible ? GLFW_TRUE : GLFW_FALSE);
  window_ = glfwCreateWindow(width, height, title.c_str(), nullptr, nullptr);
  if (!window_) {
    const std::string problem = glfw_problem();
    glfwTerminate();
    throw Error(fmt::format("the display offers no OpenGL 3.3 ({}); update the graphics driver", problem));
  }
  glfwMakeContextCurrent(window_);
  glfwSwapInterval(visible ? 1 : 0);
  glfwSetWindowUserPointer(window_, this);
  glfwSetDropCallback(window_, [](GLFWwindow* window, int count, const char** files) {
    auto* self = static_cast<Window*>(glfwGetWindowUserPointer(window));
    self->dropped_.insert(self->dropped_.end(), files, files + count);
  });
  glfwSetWindowRefreshCallback(
      window_, [](GLFWwindow* window) { static_cast<Window*>(glfwGetWindowUserPointer(window))->drawn_ = 0; });
  ImGui::CreateContext();
  ImGui::GetIO().IniFilename = nullptr;  // no file is written into the working folder
  apply_theme(content_scale());
  ImGui_ImplGlfw_InitForOpenGL(window_, true);
  ImGui_ImplOpenGL3_Init("#version 330 core");
}

Window::~Window() {
  ImGui_ImplOpenGL3_Shutdown();
  ImGui_ImplGlfw_Shutdown();
  ImGui::DestroyContext();
  glfwDestroyWindow(window_);
  glfwTerminate();
}

bool Window::should_close() const { return glfwWindowShouldClose(window_) != 0; }

void Window::set_title(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }

float Window::content_scale() const {
  float x = 1;
  float y = 1;
  glfwGetWindowContentScale(window_, &x, &y);
  return std::clamp(x, 1.0f, 4.0f);
}

void Window::begin_frame(double interval_s, const std::function<void()>& change_input) {
  for (double left = next_frame_s_ - glfwGetTime(); left > 0; left = next_frame_s_ - glfwGetTime()) {
    if (hurries_ && glfwGetTime() > hurried_s_ + 3 * interval_s) {
      hurried_s_ = next_frame_s_ = glfwGetTime();
      break;
    }
    glfwWaitEventsTimeout(left);
  }
  hurries_ = false;
  // Counts from the due time, so that delays do not accumulate, but catches up by one frame at most.
  next_frame_s_ = std::max(next_frame_s_, glfwGetTime() - interval_s) + interval_s;
  glfwPollEvents();
  ImGui_ImplOpenGL3_NewFrame();
  ImGui_ImplGlfw_NewFrame();
  change_input();
  ImGui::NewFrame();
}

void Window::hurry() {
  hurries_ = true;
  glfwPostEmptyEvent();
}

void Window::end_frame(uint64_t content) {
  ImGui::Render();
  const uint64_t print = fingerprint(*ImGui::GetDrawData(), content);
  if (print == drawn_) return;
  drawn_ = print;
  const double start_s = glfwGetTime();
  int width = 0;
  int height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glViewport(0, 0, width, height);
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  glfwSwapBuffers(window_);
  drawing_s_ += 0.2 * (glfwGetTime() - start_s - drawing_s_);
}

void Window::save(const std::filesystem::path& file) {
  // Draws again into a separate buffer: a hidden or covered window need not keep its pixels.
  int width = 0;
  int height = 0;
  glfwGetFramebufferSize(window_, &width, &height);
  GLuint texture = 0;
  GLuint frame = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_RGBA8, width, height, 0, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glGenFramebuffers(1, &frame);
  glBindFramebuffer(GL_FRAMEBUFFER, frame);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, texture, 0);
  glClearColor(0, 0, 0, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  ImGui_ImplOpenGL3_RenderDrawData(ImGui::GetDrawData());
  std::vector<unsigned char> pixels(4 * static_cast<size_t>(width) * static_cast<size_t>(height));
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
  glDeleteFramebuffers(1, &frame);
  glDeleteTextures(1, &texture);
  write_image(file, image_from_pixels(pixels, width, height));
}

std::vector<std::string> Window::take_dropped_files() { return std::exchange(dropped_, {}); }

}  // namespace relume::viewer
