#include "viewer/panels/theme.h"

#include <array>
#include <filesystem>

namespace relume::viewer {
namespace {

constexpr float kFontSize_px = 15;

ImFont* load_font(const auto& files, float size) {
  std::error_code failure;
  for (const char* file : files) {
    if (std::filesystem::exists(file, failure)) return ImGui::GetIO().Fonts->AddFontFromFileTTF(file, size);
  }
  return nullptr;
}

void load_fonts(float scale) {
  // The first existing one; else ImGui's own small font.
  constexpr std::array kSans = {
      "/usr/share/fonts/truetype/noto/NotoSans-Regular.ttf", "/usr/share/fonts/truetype/dejavu/DejaVuSans.ttf",
      "/usr/share/fonts/truetype/liberation/LiberationSans-Regular.ttf",
      "/usr/share/fonts/dejavu-sans-fonts/DejaVuSans.ttf", "/usr/share/fonts/TTF/DejaVuSans.ttf"};
  constexpr std::array kMono = {
      "/usr/share/fonts/truetype/noto/NotoSansMono-Regular.ttf", "/usr/share/fonts/truetype/dejavu/DejaVuSansMono.ttf",
      "/usr/share/fonts/truetype/liberation/LiberationMono-Regular.ttf",
      "/usr/share/fonts/dejavu-sans-mono-fonts/DejaVuSansMono.ttf", "/usr/share/fonts/TTF/DejaVuSansMono.ttf"};
  ImFontAtlas& fonts = *ImGui::GetIO().Fonts;
  if (!load_font(kSans, kFontSize_px * scale)) fonts.AddFontDefault();
  load_font(kMono, (kFontSize_px - 1) * scale);
}

ImVec4 gray(int level, float alpha = 1) {
  const float v = static_cast<float>(level) / 255;
  return {v, v * 1.03f, v * 1.1f, alpha};
}

void color_widgets(ImVec4* c) {
  const ImVec4 accent = ImGui::ColorConvertU32ToFloat4(kAccent);
  const auto tint = [&](float alpha) { return ImVec4(accent.x, accent.y, accent.z, alpha); };
  c[ImGuiCol_FrameBg] = gray(42);
  c[ImGuiCol_FrameBgHovered] = gray(52);
  c[ImGuiCol_FrameBgActive] = gray(60);
  c[ImGuiCol_CheckMark] = c[ImGuiCol_SliderGrabActive] = accent;
  c[ImGuiCol_SliderGrab] = tint(0.75f);
  c[ImGuiCol_Button] = gray(54);
  c[ImGuiCol_ButtonHovered] = gray(68);
  c[ImGuiCol_ButtonActive] = tint(0.6f);
  c[ImGuiCol_Header] = gray(46);
  c[ImGuiCol_HeaderHovered] = gray(58);
  c[ImGuiCol_HeaderActive] = tint(0.45f);
  c[ImGuiCol_Tab] = gray(34);
  c[ImGuiCol_TabHovered] = tint(0.5f);
  c[ImGuiCol_TabActive] = tint(0.35f);
  c[ImGuiCol_TextSelectedBg] = tint(0.4f);
  c[ImGuiCol_PlotHistogram] = accent;
}

}  // namespace

void apply_theme(float scale) {
  ImGui::StyleColorsDark();
  load_fonts(scale);
  ImGuiStyle& style = ImGui::GetStyle();
  style.WindowRounding = 0;
  style.ChildRounding = style.FrameRounding = style.PopupRounding = style.GrabRounding = style.TabRounding = 4;
  style.WindowBorderSize = style.FrameBorderSize = 0;
  style.WindowPadding = {12, 10};
  style.FramePadding = {7, 4};
  style.ItemSpacing = {8, 6};
  style.ScrollbarSize = 11;
  style.IndentSpacing = 14;
  style.DisabledAlpha = 0.45f;
  ImVec4* c = style.Colors;
  c[ImGuiCol_Text] = gray(222);
  c[ImGuiCol_TextDisabled] = gray(138);
  c[ImGuiCol_WindowBg] = gray(27);
  c[ImGuiCol_TitleBg] = c[ImGuiCol_TitleBgActive] = gray(42);
  c[ImGuiCol_ChildBg] = gray(27, 0);
  c[ImGuiCol_PopupBg] = gray(33, 0.98f);
  c[ImGuiCol_Border] = c[ImGuiCol_Separator] = gray(52);
  c[ImGuiCol_ScrollbarBg] = gray(27, 0);
  c[ImGuiCol_ScrollbarGrab] = gray(60);
  color_widgets(c);
  style.ScaleAllSizes(scale);
}

ImFont* monospace_font() {
  const ImVector<ImFont*>& fonts = ImGui::GetIO().Fonts->Fonts;
  return fonts.Size > 1 ? fonts[1] : fonts[0];
}

}  // namespace relume::viewer
