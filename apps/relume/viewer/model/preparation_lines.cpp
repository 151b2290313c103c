#include "viewer/model/preparation_lines.h"

#include <optional>

#include <fmt/format.h>

#include "core/activity.h"

namespace relume::viewer {
namespace {

constexpr double kMoment_s = 0.1;  // minimum time of work on the displayed scene, as shorter lines flicker

/// The rendering thread's work before its next frame; nullptr if there is none.
const char* preparation_of(const State& state) {
  const auto lasts = [&](const std::optional<double>& since_s) {
    return since_s && state.now_s - *since_s > kMoment_s;
  };
  const bool shows_scene = state.frame() && state.frame()->scene == state.document->loaded();
  if (!shows_scene || lasts(state.renderer->compiling_since_s())) return "compiling";
  return lasts(state.renderer->updating_since_s()) ? "updating" : nullptr;
}

std::string line(const char* what, const std::string& scene, const std::string& step) {
  // A step of the same kind repeats the file name.
  return fmt::format("{} {} ...{}", what, scene, step.empty() || step.starts_with(what) ? "" : "  " + step);
}

}  // namespace

std::vector<std::string> preparation_lines(const State& state) {
  const char* preparation = preparation_of(state);
  const bool loads = state.loading.valid();
  // If both are in progress, the step may belong to either.
  const std::string step = preparation && loads ? "" : current_activity().value_or("");
  std::vector<std::string> lines;
  if (preparation) lines.push_back(line(preparation, state.document->name(), step));
  if (loads) lines.push_back(line("loading", state.loading_name, step));
  return lines;
}

}  // namespace relume::viewer
