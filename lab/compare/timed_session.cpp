#include "compare/timed_session.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/clock.h"
#include "metrics/statistics.h"

namespace relume {
namespace {

constexpr double kBudgetTolerance = 0.2;
constexpr double kGoodSpread = 0.01;

/// Number of frames with the cumulative time nearest to `time_s`; at least one.
size_t nearest_count(const std::vector<double>& cumulative, double time_s) {
  const auto above = std::lower_bound(cumulative.begin(), cumulative.end(), time_s);
  if (above == cumulative.begin()) return 1;
  if (above == cumulative.end()) return cumulative.size();
  const bool below_is_nearer = time_s - *(above - 1) < *above - time_s;
  return static_cast<size_t>(above - cumulative.begin()) + (below_is_nearer ? 0 : 1);
}

}  // namespace

double wall_clock(const Session&) { return now_s(); }

TimedSession::TimedSession(const Scene& scene, const RenderSettings& settings, FrameClock clock)
    : session_(scene, settings),
      first_seed_(settings.seed),
      clock_(clock ? std::move(clock) : FrameClock(wall_clock)) {}

void TimedSession::restart(int seed) {
  session_.restart(seed);
  frame_s_.clear();
  time_s_ = 0;
  passes_before_ = session_.statistics().passes;
}

void TimedSession::render_frame() {
  const double start_s = clock_(session_);
  session_.render_frame();
  frame_s_.push_back(clock_(session_) - start_s);
  time_s_ += frame_s_.back();
}

double TimedSession::samples_per_pixel() const {
  const RenderSettings& settings = render_settings(session_);
  return static_cast<double>(session_.statistics().paths) / (double(settings.width) * settings.height);
}

uint64_t TimedSession::rays() const { return session_.statistics().rays; }

std::vector<PassTime> TimedSession::passes() const {
  std::vector<PassTime> result = pass_times_since(session_.statistics().passes, passes_before_);
  std::erase_if(result, [](const PassTime& pass) { return pass.name == "build"; });
  return result;
}

bool is_measured(uint32_t frames) {
  while (frames > 3 && frames % 2 == 0) frames /= 2;
  return frames <= 3;
}

std::vector<double> cumulative_time(const std::vector<double>& frame_s) {
  constexpr size_t kReach = 4;
  constexpr double kOutlier = 1.5;
  std::vector<double> cleaned = frame_s;
  size_t interrupted = 0;
  for (size_t i = 1; i < frame_s.size(); ++i) {
    const size_t begin = i > kReach ? i - kReach : 0;
    const size_t end = std::min(i + kReach + 1, frame_s.size());
    const double usual = median(
        {frame_s.begin() + static_cast<std::ptrdiff_t>(begin), frame_s.begin() + static_cast<std::ptrdiff_t>(end)});
    if (frame_s[i] <= kOutlier * usual) continue;
    cleaned[i] = usual;
    ++interrupted;
  }
  if (interrupted > std::max<size_t>(frame_s.size() / 16, 1)) cleaned = frame_s;
  std::vector<double> sums(cleaned.size());
  std::partial_sum(cleaned.begin(), cleaned.end(), sums.begin());
  return sums;
}

double EqualTime::spread() const {
  if (time_s.empty()) return 0;
  const auto [low, high] = std::minmax_element(time_s.begin(), time_s.end());
  return *high / *low - 1;
}

EqualTime equal_time(const std::vector<std::vector<double>>& cumulative, double budget_s) {
  std::vector<double> candidates{budget_s};
  for (const std::vector<double>& times : cumulative) {
    for (double time : times) {
      if (std::fabs(time / budget_s - 1) <= kBudgetTolerance) candidates.push_back(time);
    }
  }
  EqualTime best;
  double best_cost = std::numeric_limits<double>::infinity();
  for (double candidate : candidates) {
    EqualTime choice;
    for (const std::vector<double>& times : cumulative) {
      const size_t count = nearest_count(times, candidate);
      choice.frames.push_back(static_cast<uint32_t>(count));
      choice.time_s.push_back(times[count - 1]);
    }
    const double cost = 20 * std::max(choice.spread() - kGoodSpread, 0.0) + std::fabs(std::log(candidate / budget_s));
    if (cost >= best_cost) continue;
    best_cost = cost;
    best = std::move(choice);
  }
  return best;
}

}  // namespace relume
