// The viewport: draws the image, split view and loupe, and handles mouse and keys.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>

#include <imgui/imgui.h>

#include "viewer/model/frame_display.h"
#include "viewer/model/state.h"
#include "viewer/render/gl_image.h"

namespace relume::viewer {

/// A rectangle in the window, in interface pixels.
struct Rect {
  ImVec2 at{0, 0};
  ImVec2 size{0, 0};

  bool contains(const ImVec2& p) const {
    return p.x >= at.x && p.y >= at.y && p.x < at.x + size.x && p.y < at.y + size.y;
  }
  ImVec2 end() const { return {at.x + size.x, at.y + size.y}; }
};

/// Binds an OpenGL sampler from within a draw list; the callback's data is its name.
void bind_sampler(const ImDrawList*, const ImDrawCmd* command);

/// A texture as Dear ImGui's type.
inline ImTextureID as_texture(GLuint name) { return std::bit_cast<ImTextureID>(uintptr_t{name}); }
inline void* as_callback_data(GLuint name) { return std::bit_cast<void*>(uintptr_t{name}); }

class Viewport {
 public:
  /// Uploads new frames to the GPU and converts them to display colours, once the table of --ocio is ready.
  void update(State& state);

  /// Draws into `room` and handles the mouse in it.
  void draw(State& state, const Rect& room);

  /// Rectangle of the last drawn image.
  const Rect& image() const { return image_; }

  /// Counts changes of the textures.
  uint64_t version() const { return version_; }

  /// Point of the image under the mouse, (0, 0) its top left corner.
  Vec2 point_under_mouse() const;

  /// Text of describe_pixel() for the pixel and side under the mouse, as last drawn; empty outside.
  const std::string& values_under_mouse() const { return under_mouse_; }

 private:
  void draw_image(State& state);
  void draw_split(State& state);
  void draw_selection_box(const State& state) const;
  void draw_lights(State& state);
  void draw_overlay(const State& state) const;
  void draw_loupe(const State& state) const;
  std::string describe_under_mouse(const State& state) const;
  void draw_values() const;
  void handle_mouse(State& state);
  bool project(const State& state, const Vec3& p, ImVec2& at) const;

  enum class Drag { none, turn, pan, move, split };

  Drag drag_that_begins(const State& state) const;

  DisplayShader display_shader_;
  std::array<GlImage, kSides> images_;
  FrameDisplay display_;
  uint64_t version_ = 0;
  Rect image_;
  Drag drag_ = Drag::none;
  float dragged_px_ = 0;
  std::string under_mouse_;
  IVec2 size_wanted_{0};
  double size_wanted_s_ = 0;
};

/// Moves the camera, and executes key commands.
void handle_keys(State& state, float image_height_px);

/// The list of keys, as an overlay.
void draw_help(State& state);

}  // namespace relume::viewer
