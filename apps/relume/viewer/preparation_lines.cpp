#include "viewer/preparation_lines.h"

#include <optional>

#include <fmt/format.h>

#include "core/activity.h"

namespace relume::viewer {
namespace {

constexpr double kMoment_s = 0.1;  // minimum time of recompilation, as shorter lines flicker

bool is_compiling(const State& state) {
  if (!state.frame() || state.frame()->scene != state.document->loaded()) return true;
  const std::optional<double> since_s = state.renderer->compiling_since_s();
  return since_s && state.now_s - *since_s > kMoment_s;
}

std::string line(const char* what, const std::string& scene, const std::string& step) {
  // A step of the same kind repeats the file name.
  return fmt::format("{} {} ...{}", what, scene, step.empty() || step.starts_with(what) ? "" : "  " + step);
}

}  // namespace

std::vector<std::string> preparation_lines(const State& state) {
  const bool compiles = is_compiling(state);
  const bool loads = state.loading.valid();
  // If both are in progress, the step may belong to either.
  const std::string step = compiles && loads ? "" : current_activity().value_or("");
  std::vector<std::string> lines;
  if (compiles) lines.push_back(line("compiling", state.document->name(), step));
  if (loads) lines.push_back(line("loading", state.loading_name, step));
  return lines;
}

}  // namespace relume::viewer
