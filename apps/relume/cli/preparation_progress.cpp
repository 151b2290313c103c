#include "cli/preparation_progress.h"

#include <chrono>
#include <cstdio>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "cli/console.h"
#include "cli/platform.h"
#include "core/activity.h"

namespace relume::cli {

PreparationProgress::PreparationProgress(bool enabled, double patience_s) {
  if (!enabled || !is_terminal(stderr)) return;
  thread_ = std::jthread([this, patience_s](const std::stop_token& stop) { show(stop, patience_s); });
}

PreparationProgress::~PreparationProgress() = default;

void PreparationProgress::show(const std::stop_token& stop, double patience_s) {
  constexpr std::chrono::milliseconds kInterval(100);
  std::unique_lock lock(mutex_);
  const auto wait = [&](const auto& duration) { wake_.wait_for(lock, stop, duration, [] { return false; }); };
  wait(std::chrono::duration<double>(patience_s));
  std::string shown;
  while (!stop.stop_requested()) {
    const std::string activity = printable(current_activity().value_or(""));
    const std::string line(first_characters(activity, terminal_columns() - 1));
    if (line != shown) {
      // Column 0, the line, and clear the remainder.
      std::fputs(fmt::format("\r{}\x1b[K", line).c_str(), stderr);
      std::fflush(stderr);
      shown = line;
    }
    wait(kInterval);
  }
  if (!shown.empty()) std::fputs("\r\x1b[K", stderr);
}

}  // namespace relume::cli
