#include "viewer/model/monitor.h"

#include <algorithm>

namespace relume::viewer {
namespace {

constexpr double kRenderedWindow_s = 3;
constexpr double kNever = -1;  // none until the next frame of the interface

double rate(const std::deque<double>& times) {
  if (times.size() < 2 || times.back() <= times.front()) return 0;
  return static_cast<double>(times.size() - 1) / (times.back() - times.front());
}

/// Removes entries before `from`, but keeps the latest `fewest`.
void trim(std::deque<double>& times, double from, size_t fewest) {
  while (times.size() > fewest && times.front() < from) times.pop_front();
}

}  // namespace

void Monitor::interface_frame(double now_s) {
  if (since_s_ == kNever) since_s_ = now_s;
  if (!shown_s_.empty() && since_s_) longest_gap_s_ = std::max(longest_gap_s_, now_s - shown_s_.back());
  shown_s_.push_back(now_s);
  trim(shown_s_, now_s - 1, 1);
  if (since_s_ && now_s - *since_s_ >= 1)
    worst_hz_ = std::min(worst_hz_.value_or(1e9), static_cast<double>(shown_s_.size()));
}

void Monitor::rendered_frame(double now_s) {
  if (!since_s_) since_s_ = now_s;
  rendered_s_.push_back(now_s);
  trim(rendered_s_, now_s - kRenderedWindow_s, 2);
}

void Monitor::camera_seen(uint64_t frames) { latency_ = std::max(latency_, frames); }

double Monitor::interface_hz() const { return rate(shown_s_); }
double Monitor::frames_per_s() const { return rate(rendered_s_); }

void Monitor::interrupt() {
  if (since_s_ && !shown_s_.empty()) since_s_ = kNever;
  shown_s_.clear();
}

void Monitor::reset() {
  since_s_ = shown_s_.empty() ? since_s_ : std::optional(shown_s_.back());
  rendered_s_.clear();
  worst_hz_.reset();
  longest_gap_s_ = 0;
  latency_ = 0;
}

}  // namespace relume::viewer
