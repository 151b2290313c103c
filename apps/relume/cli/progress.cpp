#include "cli/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include <fmt/format.h>

#include "cli/console.h"
#include "cli/platform.h"
#include "core/clock.h"

namespace relume::cli {
namespace {

constexpr int kBarLength = 24;
constexpr double kBarInterval_s = 0.1;
constexpr double kLineInterval_s = 10;

}  // namespace

std::string format_duration(double seconds) {
  const auto total = static_cast<int64_t>(std::llround(std::clamp(seconds, 0.0, 1e12)));
  const int64_t hours = total / 3600;
  if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, total / 60 % 60, total % 60);
  return fmt::format("{}:{:02}", total / 60, total % 60);
}

std::string format_progress(const Progress& progress) {
  std::string text = progress.label.empty() ? "" : progress.label + ", ";
  if (!progress.shows_samples) return text + fmt::format("{:.0f} %", 100 * progress.fraction);
  text += progress.samples_wanted > 0 ? fmt::format("{}/{} samples", progress.samples, progress.samples_wanted)
                                      : fmt::format("{} samples", progress.samples);
  if (progress.rays_per_s > 0) text += fmt::format(", {:.1f} Mrays/s", progress.rays_per_s * 1e-6);
  if (progress.error > 0 && std::isfinite(progress.error)) text += fmt::format(", error {:.2g}", progress.error);
  if (std::isfinite(progress.remaining_s)) text += fmt::format(", {} left", format_duration(progress.remaining_s));
  return text;
}

std::string format_progress_bar(const Progress& progress, int columns) {
  const auto filled = static_cast<int>(std::clamp(progress.fraction, 0.0, 1.0) * kBarLength);
  const std::string text =
      fmt::format("[{:#<{}}{: <{}}] {}", "", filled, "", kBarLength - filled, format_progress(progress));
  return std::string(first_characters(text, columns));
}

ProgressPrinter::ProgressPrinter(bool enabled) : enabled_(enabled), terminal_(is_terminal(stderr)) {}

ProgressPrinter::~ProgressPrinter() { clear(); }

void ProgressPrinter::show_stage(const std::string& stage, double fraction) {
  constexpr double kUnknown_s = std::numeric_limits<double>::infinity();
  show({.label = stage, .fraction = fraction, .remaining_s = kUnknown_s, .shows_samples = false}, now_s());
}

void ProgressPrinter::show(const Progress& progress, double now_s) {
  if (!enabled_) return;
  if (!started_) {
    started_ = true;
    next_s_ = terminal_ ? now_s : now_s + kLineInterval_s;  // short renders need no line
  }
  if (now_s < next_s_) return;
  next_s_ = now_s + (terminal_ ? kBarInterval_s : kLineInterval_s);
  if (terminal_) {
    // Column 0, the bar, and clear the remainder.
    std::fputs(fmt::format("\r{}\x1b[K", format_progress_bar(progress, terminal_columns() - 1)).c_str(), stderr);
    bar_shown_ = true;
  } else {
    std::fputs((format_progress(progress) + "\n").c_str(), stderr);
  }
  std::fflush(stderr);
}

void ProgressPrinter::clear() {
  if (!bar_shown_) return;
  std::fputs("\r\x1b[K", stderr);
  std::fflush(stderr);
  bar_shown_ = false;
}

}  // namespace relume::cli
