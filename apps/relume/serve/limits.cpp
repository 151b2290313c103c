#include "serve/limits.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

namespace relume::serve {

void RateLimiter::refill(double now_s) {
  if (now_s > last_s_) left_ = std::min(at_once_, left_ + (now_s - last_s_) * per_second_);
  last_s_ = std::max(last_s_, now_s);
}

bool RateLimiter::take(double units, double now_s) {
  refill(now_s);
  if (left_ < units) return false;
  left_ -= units;
  return true;
}

double RateLimiter::wait_s(double units, double now_s) {
  refill(now_s);
  if (units > at_once_) return std::numeric_limits<double>::infinity();
  return std::max(0.0, (units - left_) / per_second_);
}

std::string ScreenshotLimit::begin(RateLimiter& all, double now_s) {
  if (waits_) return "a screenshot is in progress; wait for its download";
  const double wait_s = std::max(rate_.wait_s(1, now_s), all.wait_s(1, now_s));
  if (wait_s > 0)
    return fmt::format("the limit of screenshots is reached; take the next one in {:.0f} s", std::ceil(wait_s));
  rate_.take(1, now_s);
  all.take(1, now_s);
  waits_ = true;
  return {};
}

std::optional<uint64_t> WaitingRoom::enter(uint64_t connection, const std::string& address) {
  std::optional<uint64_t> replaced;
  const bool crowds = count_of(address) >= per_address_;
  if (crowds || waiting_.size() >= total_) {
    const std::string from = crowds ? address : largest();
    const auto oldest =
        std::find_if(waiting_.begin(), waiting_.end(), [&](const Entry& entry) { return entry.address == from; });
    replaced = oldest->connection;
    waiting_.erase(oldest);
  }
  waiting_.push_back({connection, address});
  return replaced;
}

void WaitingRoom::leave(uint64_t connection) {
  std::erase_if(waiting_, [&](const Entry& entry) { return entry.connection == connection; });
}

size_t WaitingRoom::count_of(const std::string& address) const {
  const auto count =
      std::count_if(waiting_.begin(), waiting_.end(), [&](const Entry& entry) { return entry.address == address; });
  return static_cast<size_t>(count);
}

std::string WaitingRoom::largest() const {
  std::string found;
  size_t most = 0;
  for (const Entry& entry : waiting_) {
    if (entry.address == found) continue;
    if (const size_t count = count_of(entry.address); count > most) {
      most = count;
      found = entry.address;
    }
  }
  return found;
}

}  // namespace relume::serve
