#include "serve/link_control.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace relume::serve {
namespace {

constexpr double kInterval_s = 1.0 / 30;
constexpr size_t kLeastWindow = 2;
constexpr size_t kMostWindow = 8;
constexpr double kBasePeriod_s = 5;
constexpr double kLongQueue_s = 0.12;   // lowers the level at once
constexpr double kShortQueue_s = 0.03;  // permits raising it
constexpr double kPeriod_s = 1;         // in which frames are counted
constexpr int kLeastOffered = 8;
constexpr double kMissedShare = 0.25;
constexpr double kSettle_s = 0.5;       // after a change, frames of the old level are still under way
constexpr double kFailed_s = 4;         // a level that is lowered within this time of its raise was too high
constexpr double kLeastPatience_s = 2;  // of a good link, before its level is raised
constexpr double kMostPatience_s = 30;

}  // namespace

double LinkControl::base_delay_s() const {
  if (shortest_s_[0] == 0) return shortest_s_[1];
  return shortest_s_[1] == 0 ? shortest_s_[0] : std::min(shortest_s_[0], shortest_s_[1]);
}

size_t LinkControl::window() const {
  const auto frames = static_cast<size_t>(std::ceil(std::min(base_delay_s(), 1.0) / kInterval_s));
  return std::clamp(1 + frames, kLeastWindow, kMostWindow);
}

bool LinkControl::offer(uint64_t view, double now_s) {
  if (now_s - period_since_s_ > kPeriod_s) start_period(now_s);
  const bool room = under_way_.size() < window();
  if (room) {
    ++offered_;
  } else if (view != missed_view_ && now_s - under_way_.back().at_s >= kInterval_s) {
    ++offered_;
    ++missed_;
    missed_view_ = view;
  }
  return room;
}

void LinkControl::start_period(double now_s) {
  const bool missed = offered_ >= kLeastOffered && missed_ > kMissedShare * offered_;
  period_since_s_ = now_s;
  offered_ = missed_ = 0;
  if (missed) lower(1, now_s);
}

void LinkControl::sent(uint32_t frame, double now_s) { under_way_.push_back({frame, now_s}); }

void LinkControl::acknowledged(uint32_t frame, double now_s) {
  const auto found =
      std::find_if(under_way_.begin(), under_way_.end(), [&](const Sent& s) { return s.frame == frame; });
  if (found == under_way_.end()) return;
  delay_s_ = std::max(now_s - found->at_s, 1e-6);
  under_way_.erase(under_way_.begin(), found + 1);
  if (now_s - base_since_s_ > kBasePeriod_s) {
    shortest_s_ = {0, shortest_s_[0]};
    base_since_s_ = now_s;
  }
  shortest_s_[0] = shortest_s_[0] == 0 ? delay_s_ : std::min(shortest_s_[0], delay_s_);
  judge(delay_s_ - base_delay_s(), now_s);
}

void LinkControl::judge(double queue_s, double now_s) {
  if (queue_s > kLongQueue_s) return lower(queue_s > 3 * kLongQueue_s ? 2 : 1, now_s);
  if (queue_s > kShortQueue_s || missed_ > kMissedShare * std::max(offered_, kLeastOffered)) {
    good_since_s_ = now_s;
  } else if (now_s - good_since_s_ > raise_after_s_) {
    raise(now_s);
  }
}

void LinkControl::lower(int by, double now_s) {
  good_since_s_ = now_s;
  if (now_s - changed_s_ < kSettle_s) return;
  if (now_s - raised_s_ < kFailed_s) {
    raise_after_s_ = std::min(2 * raise_after_s_, kMostPatience_s);
    raise_failed_ = true;
  }
  level_ = std::min(level_ + by, static_cast<int>(kLevels.size()) - 1);
  changed_s_ = now_s;
  offered_ = missed_ = 0;
}

void LinkControl::raise(double now_s) {
  good_since_s_ = now_s;
  if (level_ == 0) return;
  if (!std::exchange(raise_failed_, false)) raise_after_s_ = std::max(raise_after_s_ / 2, kLeastPatience_s);
  --level_;
  changed_s_ = raised_s_ = now_s;
}

}  // namespace relume::serve
