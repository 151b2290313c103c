#include "frame/device_queue.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

// A stop waits for the bands in the queue and the one that was added last. Both estimates may be exceeded where
// elements take longer than those before them.
constexpr double kBandSeconds = 0.010;
constexpr double kQueueSeconds = 0.015;

/// Launches up to this time may wait for later ones. Their start would take a share of their time; that of longer ones
/// takes little.
constexpr double kShortSeconds = 0.002;

// The first band of a kernel is small, because its time is unknown. Later ones have at most so many times the threads
// of the largest so far: the time of a band grows at most in proportion.
constexpr uint64_t kGrowth = 8;          ///< after bands that took less than kBandSeconds / kGrowth
constexpr uint64_t kSmallestGrowth = 2;  ///< after longer ones

/// 1 / kSideBySide of the device's threads fit on it with the most registers per thread, and take the time of one. So
/// smaller bands of a known kernel would be no shorter.
constexpr uint64_t kSideBySide = 8;

/// Share of a kernel's time per thread that a faster band leaves. Bands keep to the slowest part of earlier frames.
constexpr double kDecay = 0.9;

/// Threads of one element.
uint64_t element_threads(const DeviceLaunch& launch) { return std::max(launch.threads, 1u); }

uint64_t threads_of(const DeviceLaunch& launch) {
  return element_threads(launch) * launch.window.width() * launch.window.height();
}

/// The largest multiple up to a number, at least one block.
uint64_t whole_blocks(uint64_t elements, uint32_t block) { return std::max<uint64_t>(elements / block, 1) * block; }

/// Divides a window into bands: whole rows, or columns of one row of blocks.
class Bands {
 public:
  Bands(const Tile& window, const ElementBlock& block) : window_(window), block_(block), x_(window.x0), y_(window.y0) {}

  bool empty() const { return y_ >= window_.y1; }
  /// The next band, of about `elements` elements, but at least a block.
  Tile take(uint64_t elements) {
    if (x_ == window_.x0) {
      const uint64_t rows = whole_blocks(elements / window_.width(), block_.height);
      rows_ = static_cast<uint32_t>(std::min<uint64_t>(rows, window_.y1 - y_));
    }
    const uint64_t columns = whole_blocks(elements / rows_, block_.width);
    const auto width = static_cast<uint32_t>(std::min<uint64_t>(columns, window_.x1 - x_));
    const Tile band{x_, y_, x_ + width, y_ + rows_};
    x_ = band.x1;
    if (x_ == window_.x1) {
      x_ = window_.x0;
      y_ = band.y1;
    }
    return band;
  }

 private:
  Tile window_;
  ElementBlock block_;
  uint32_t x_;
  uint32_t y_;
  uint32_t rows_ = 0;  ///< of the current bands
};

}  // namespace

DeviceQueue::DeviceQueue(Device& device, std::function<void(std::string_view, double)> add_time)
    : device_(device), add_time_(std::move(add_time)) {}
DeviceQueue::~DeviceQueue() { discard(); }

bool DeviceQueue::launch(const DeviceLaunch& launch, const std::stop_token& stop,
                         const std::function<void()>& before_band) {
  try {
    if (stop.stop_possible()) return launch_bands(launch, stop, before_band);
    if (before_band) before_band();
    add(launch, estimate_of(launch), false);
    return true;
  } catch (...) {
    discard();
    throw;
  }
}

bool DeviceQueue::launch_bands(const DeviceLaunch& launch, const std::stop_token& stop,
                               const std::function<void()>& before_band) {
  const ElementBlock block = launch.threads > 0 ? ElementBlock{} : device_.block(launch.window);
  Estimate& estimate = estimate_of(launch);
  for (Bands bands(launch.window, block); !bands.empty();) {
    make_room();
    if (before_band) before_band();
    if (stop.stop_requested()) return false;
    const uint64_t fitting = fitting_threads(estimate);
    DeviceLaunch band = launch;
    band.window = bands.take(std::min(fitting, estimate.most_threads) / element_threads(launch));
    add(band, estimate, fitting > estimate.most_threads && !bands.empty());
  }
  return true;
}

bool DeviceQueue::may_wait(double expected_s) {
  kept_s_ += expected_s;
  if (expected_s <= kShortSeconds && kept_s_ <= kBandSeconds) return true;
  kept_s_ = 0;
  return false;
}

void DeviceQueue::add(const DeviceLaunch& launch, Estimate& estimate, bool is_trial) {
  const uint64_t threads = threads_of(launch);
  const double expected_s = is_trial ? kQueueSeconds : expected_seconds(estimate, threads);
  DeviceLaunch band = launch;
  band.may_wait = may_wait(expected_s);
  device_.launch(band);
  bands_.push_back({std::string(band.name), &estimate, threads, expected_s});
  expected_s_ += expected_s;
}

DeviceQueue::Estimate& DeviceQueue::estimate_of(const DeviceLaunch& launch) {
  return estimates_[{std::string(launch.kernel), std::string(launch.name)}];
}

bool DeviceQueue::fills_device(const Estimate& estimate) const {
  return estimate.thread_s * device_.parallel_threads() <= kBandSeconds;
}

double DeviceQueue::expected_seconds(const Estimate& estimate, uint64_t threads) const {
  if (estimate.thread_s <= 0) return kQueueSeconds;
  const uint64_t timed = fills_device(estimate) ? std::max<uint64_t>(threads, device_.parallel_threads()) : threads;
  return estimate.thread_s * static_cast<double>(timed);
}

uint64_t DeviceQueue::fitting_threads(const Estimate& estimate) const {
  constexpr double kMost = 1e15;
  const double fitting = estimate.thread_s > 0 ? std::min(kBandSeconds / estimate.thread_s, kMost) : kMost;
  return std::max<uint64_t>(static_cast<uint64_t>(fitting), device_.parallel_threads() / kSideBySide);
}

void DeviceQueue::learn(Estimate& estimate, uint64_t threads, double seconds) const {
  const bool is_long = seconds > kBandSeconds;
  const uint64_t timed = is_long ? threads : std::max<uint64_t>(threads, device_.parallel_threads());
  estimate.thread_s = std::max(seconds / static_cast<double>(timed), kDecay * estimate.thread_s);
  const uint64_t growth = seconds < kBandSeconds / kGrowth ? kGrowth : kSmallestGrowth;
  estimate.most_threads = std::max(estimate.most_threads, growth * threads);
}

void DeviceQueue::make_room() {
  collect_times();
  while (!bands_.empty() && expected_s_ >= kQueueSeconds) {
    kept_s_ = 0;
    device_.wait(bands_.size() - 1);
    collect_times();
  }
}

void DeviceQueue::collect_times() {
  for (const double seconds : device_.take_times()) {
    const Band band = std::move(bands_.front());
    bands_.pop_front();
    expected_s_ = bands_.empty() ? 0 : expected_s_ - band.expected_s;
    add_time_(band.name, seconds);
    learn(*band.estimate, band.threads, seconds);
  }
  if (const double seconds = device_.take_move_time(); seconds > 0) add_time_("moves", seconds);
}

void DeviceQueue::finish() {
  kept_s_ = 0;
  try {
    device_.finish();
    collect_times();
  } catch (...) {
    discard();
    throw;
  }
}

void DeviceQueue::discard() noexcept {
  try {
    device_.finish();
    device_.take_times();
    device_.take_move_time();
  } catch (...) {  // the queue is empty after any error
  }
  bands_.clear();
  expected_s_ = 0;
  kept_s_ = 0;
}

}  // namespace relume
