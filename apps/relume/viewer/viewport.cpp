#include "viewer/viewport.h"

#include <algorithm>
#include <cmath>

#include "scene/light_parameters.h"
#include "viewer/model/actions.h"
#include "viewer/panels/theme.h"

namespace relume::viewer {
namespace {

constexpr float kClick_px = 4;      // a button press that moves less is a click
constexpr float kHandle_px = 6;     // distance from the split line within which it can be dragged
constexpr double kSettle_s = 0.15;  // delay after the window is resized

/// The largest rectangle of the aspect ratio within `room`.
Rect fit(const Rect& room, float aspect) {
  ImVec2 size = room.size;
  if (size.x > size.y * aspect) {
    size.x = size.y * aspect;
  } else {
    size.y = size.x / aspect;
  }
  const ImVec2 at(std::floor(room.at.x + 0.5f * (room.size.x - size.x)),
                  std::floor(room.at.y + 0.5f * (room.size.y - size.y)));
  return {at, {std::floor(size.x), std::floor(size.y)}};
}

/// Resizes the image with its area, once that has settled.
void follow_room(State& state, const Rect& room, IVec2& wanted, double& wanted_s) {
  const IVec2 size(std::clamp(static_cast<int>(room.size.x) / 2 * 2, 64, 8192),
                   std::clamp(static_cast<int>(room.size.y) / 2 * 2, 64, 8192));
  if (size != wanted) wanted_s = state.now_s;
  wanted = size;
  const RenderSettings& a = state.settings[0].render;
  if (!state.follow_window || size == IVec2(a.width, a.height)) return;
  if (state.frame() && state.now_s - wanted_s < kSettle_s) return;
  for (AllSettings& settings : state.settings) {
    settings.render.width = size.x;
    settings.render.height = size.y;
  }
  state.touch();
}

}  // namespace

// ImGui 1.86 does not copy callback data, so the pointer itself encodes the sampler's name.
void bind_sampler(const ImDrawList*, const ImDrawCmd* command) {
  glBindSampler(0, static_cast<GLuint>(reinterpret_cast<uintptr_t>(command->UserCallbackData)));
}

void Viewport::update(State& state) {
  if (!state.ocio.ready()) return;
  for (int side = 0; side < kSides; ++side) {
    const auto s = static_cast<size_t>(side);
    const ViewerFrame* frame = state.frames[s].get();
    if (!frame) continue;
    if (display_.update(state, side)) images_[s].show(*frame);
    if (images_[s].to_display(display_shader_, display_.transform(state, side))) ++version_;
  }
}

Vec2 Viewport::point_under_mouse() const {
  const ImVec2 mouse = ImGui::GetIO().MousePos;
  return {(mouse.x - image_.at.x) / image_.size.x, (mouse.y - image_.at.y) / image_.size.y};
}

void Viewport::draw_image(State& state) {
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const ImVec2 end = image_.end();
  if (state.sharp_pixels) {
    list.AddCallback(bind_sampler, as_callback_data(display_shader_.nearest_sampler()));
  }
  list.AddImage(as_texture(images_[0].texture()), image_.at, end);
  if (state.split && state.frames[1] && !images_[1].empty()) {
    const float x = std::floor(image_.at.x + state.split_at * image_.size.x);
    list.AddImage(as_texture(images_[1].texture()), {x, image_.at.y}, end, {state.split_at, 0}, {1, 1});
  }
  if (state.sharp_pixels) list.AddCallback(ImDrawCallback_ResetRenderState, nullptr);
}

void Viewport::draw_split(State& state) {
  if (!state.split) return;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float x = image_.at.x + state.split_at * image_.size.x;
  const float middle = image_.at.y + 0.5f * image_.size.y;
  list.AddLine({x, image_.at.y}, {x, image_.end().y}, kAccent, 2);
  list.AddCircleFilled({x, middle}, 9, kAccent);
  list.AddText({x - 5, middle - 0.5f * ImGui::GetFontSize()}, IM_COL32(20, 20, 24, 255), "||");
  const auto label = [&](const char* text, float at_x) {
    const ImVec2 size = ImGui::CalcTextSize(text);
    const ImVec2 at(at_x, image_.end().y - size.y - 18);
    list.AddRectFilled({at.x - 7, at.y - 4}, {at.x + size.x + 7, at.y + size.y + 4}, kOverlay, 4);
    list.AddText(at, kAccent, text);
  };
  label("A", x - 30);
  label("B", x + 20);
}

bool Viewport::project(const State& state, const Vec3& p, ImVec2& at) const {
  const CameraPose placed = current_camera(state);
  if (placed.camera.projection == Projection::panoramic) return false;
  const Vec3 d = p - Vec3(placed.to_world[3]);
  const float depth = -glm::dot(d, glm::normalize(Vec3(placed.to_world[2])));
  const bool perspective = placed.camera.projection == Projection::perspective;
  if (perspective && depth < 1e-3f) return false;
  const float half = perspective ? depth * std::tan(0.5f * placed.camera.fov_y_rad) : placed.camera.half_height;
  const float aspect = image_.size.x / image_.size.y;
  const float x = glm::dot(d, glm::normalize(Vec3(placed.to_world[0]))) / (half * aspect);
  const float y = glm::dot(d, glm::normalize(Vec3(placed.to_world[1]))) / half;
  at = {image_.at.x + 0.5f * (x + 1) * image_.size.x, image_.at.y + 0.5f * (1 - y) * image_.size.y};
  return true;
}

void Viewport::draw_selection_box(const State& state) const {
  constexpr size_t kMostBoxes = 64;
  if (state.selection.kind != Selected::node) return;
  for (const auto& [box, to_world] : state.document->boxes(state.selection.index, kMostBoxes)) {
    std::array<ImVec2, 8> corners;
    bool visible = !box.empty();
    for (int i = 0; i < 8 && visible; ++i) {
      const Vec3 p((i & 1) != 0 ? box.high.x : box.low.x, (i & 2) != 0 ? box.high.y : box.low.y,
                   (i & 4) != 0 ? box.high.z : box.low.z);
      visible = project(state, transform_point(to_world, p), corners[static_cast<size_t>(i)]);
    }
    for (int i = 0; i < 8 && visible; ++i) {
      for (const int bit : {1, 2, 4}) {
        if ((i & bit) != 0) continue;
        ImGui::GetWindowDrawList()->AddLine(corners[static_cast<size_t>(i)], corners[static_cast<size_t>(i | bit)],
                                            kAccent, 1.5f);
      }
    }
  }
}

void Viewport::draw_lights(State& state) {
  const Scene& scene = state.document->outline();
  if (!state.show_panels || state.panel != Panel::scene || scene.lights.size() > 200) return;
  ImDrawList& list = *ImGui::GetWindowDrawList();
  for (size_t i = 0; i < scene.lights.size(); ++i) {
    const Index node = state.document->node_of_light(static_cast<Index>(i));
    if (node == kNone || type_of(scene.lights[i]).at_infinity) continue;
    ImVec2 at;
    if (!project(state, Vec3(state.document->world()[static_cast<size_t>(node)][3]), at) || !image_.contains(at))
      continue;
    const bool chosen = state.selection.kind == Selected::light && state.selection.index == static_cast<Index>(i);
    list.AddCircleFilled(at, 5, IM_COL32(255, 240, 200, 255));
    list.AddCircle(at, chosen ? 10 : 7, chosen ? kAccent : IM_COL32(20, 20, 24, 200), 0, 2);
  }
}

void Viewport::draw(State& state, const Rect& room) {
  follow_room(state, room, size_wanted_, size_wanted_s_);
  const RenderSettings& render = state.settings[0].render;
  image_ = fit(room, static_cast<float>(render.width) / static_cast<float>(render.height));
  ImDrawList& list = *ImGui::GetWindowDrawList();
  // Fills only the margin around the image: with software rendering, every pixel costs.
  constexpr ImU32 kMargin = IM_COL32(14, 15, 18, 255);
  const ImVec2 end = image_.end();
  list.AddRectFilled(room.at, {room.end().x, image_.at.y}, kMargin);
  list.AddRectFilled({room.at.x, end.y}, room.end(), kMargin);
  list.AddRectFilled({room.at.x, image_.at.y}, {image_.at.x, end.y}, kMargin);
  list.AddRectFilled({end.x, image_.at.y}, {room.end().x, end.y}, kMargin);
  ImGui::SetCursorScreenPos(room.at);
  ImGui::InvisibleButton(
      "image", room.size,
      ImGuiButtonFlags_MouseButtonLeft | ImGuiButtonFlags_MouseButtonRight | ImGuiButtonFlags_MouseButtonMiddle);
  if (!state.document) return;
  under_mouse_ = describe_under_mouse(state);
  if (!images_[0].empty()) draw_image(state);
  list.PushClipRect(image_.at, image_.end(), true);
  draw_selection_box(state);
  draw_lights(state);
  draw_split(state);
  list.PopClipRect();
  handle_mouse(state);
  draw_overlay(state);
}

Viewport::Drag Viewport::drag_that_begins(const State& state) const {
  const ImGuiIO& io = ImGui::GetIO();
  if (!io.MouseDown[ImGuiMouseButton_Left]) return Drag::pan;
  const float line = image_.at.x + state.split_at * image_.size.x;
  if (state.split && std::fabs(io.MousePos.x - line) < kHandle_px) return Drag::split;
  if (io.KeyCtrl != io.KeyShift) return io.KeyCtrl ? Drag::move : Drag::pan;
  return Drag::turn;
}

void Viewport::handle_mouse(State& state) {
  const ImGuiIO& io = ImGui::GetIO();
  const bool held = ImGui::IsItemActive();
  const Vec2 point = point_under_mouse();
  if (ImGui::IsItemActivated()) {
    drag_ = drag_that_begins(state);
    dragged_px_ = 0;
  }
  if (held) {
    dragged_px_ += std::fabs(io.MouseDelta.x) + std::fabs(io.MouseDelta.y);
    if (drag_ == Drag::split) state.split_at = clamp(point.x, 0.02f, 0.98f);
    if (drag_ == Drag::move && (io.MouseDelta.x != 0 || io.MouseDelta.y != 0))
      drag_selection(state, Vec2(io.MouseDelta.x, io.MouseDelta.y) / image_.size.y);
  }
  if (ImGui::IsItemDeactivated()) {
    const bool click = dragged_px_ < kClick_px && drag_ == Drag::turn && image_.contains(io.MousePos);
    if (click && io.KeyAlt) {
      show_directions_at(state, point);
    } else if (click) {
      pick_at(state, point, io.KeyCtrl && io.KeyShift);
    }
    drag_ = Drag::none;
  }
  if (held && dragged_px_ >= kClick_px) {
    if (drag_ == Drag::turn) state.navigation.turn_px = {io.MouseDelta.x, io.MouseDelta.y};
    if (drag_ == Drag::pan) state.navigation.pan_px = {io.MouseDelta.x, io.MouseDelta.y};
  }
  if (!ImGui::IsItemHovered()) return;
  state.navigation.notches = io.MouseWheel;
  if (!under_mouse_.empty() && !held) {
    draw_values();
    if (state.inspector.loupe) draw_loupe(state);
  }
}

}  // namespace relume::viewer
