#include "frame/device_queue.h"

#include <algorithm>
#include <utility>

namespace relume {
namespace {

// A stop waits for the bands in the queue and the one that was added last. Both estimates may be exceeded where
// elements take longer than those before them.
constexpr double kBandSeconds = 0.010;
constexpr double kQueueSeconds = 0.015;

/// Share of a kernel's time per thread that a faster band leaves. Bands keep to the slowest part of earlier frames.
constexpr double kDecay = 0.9;

/// Threads of one element.
uint64_t element_threads(const DeviceLaunch& launch) { return std::max(launch.threads, 1u); }

/// Threads whose time a launch takes: at least those that the device executes at the same time.
uint64_t timed_threads(const DeviceLaunch& launch, const Device& device) {
  const uint64_t elements = uint64_t{launch.window.width()} * launch.window.height();
  return std::max<uint64_t>(element_threads(launch) * elements, device.parallel_threads());
}

}  // namespace

DeviceQueue::DeviceQueue(Device& device, std::function<void(std::string_view, double)> add_time)
    : device_(device), add_time_(std::move(add_time)) {}
DeviceQueue::~DeviceQueue() { discard(); }

bool DeviceQueue::launch(const DeviceLaunch& launch, const std::stop_token& stop,
                         const std::function<void()>& before_band) {
  try {
    if (stop.stop_possible()) return launch_bands(launch, stop, before_band);
    if (before_band) before_band();
    add(launch);
    return true;
  } catch (...) {
    discard();
    throw;
  }
}

bool DeviceQueue::launch_bands(const DeviceLaunch& launch, const std::stop_token& stop,
                               const std::function<void()>& before_band) {
  const Tile& window = launch.window;
  const bool by_columns = window.height() == 1;
  const uint32_t count = by_columns ? window.width() : window.height();
  const uint64_t threads = element_threads(launch) * (by_columns ? 1 : window.width());
  for (uint32_t first = 0; first < count;) {
    make_room();
    if (before_band) before_band();
    if (stop.stop_requested()) return false;
    const uint64_t fitting = std::max<uint64_t>(band_threads(launch.kernel) / threads, 1);
    const auto end = static_cast<uint32_t>(std::min<uint64_t>(first + fitting, count));
    DeviceLaunch band = launch;
    if (by_columns) {
      band.window = {window.x0 + first, window.y0, window.x0 + end, window.y1};
    } else {
      band.window = {window.x0, window.y0 + first, window.x1, window.y0 + end};
    }
    add(band);
    first = end;
  }
  return true;
}

void DeviceQueue::add(const DeviceLaunch& band) {
  const auto threads = static_cast<double>(timed_threads(band, device_));
  const auto known = thread_seconds_.find(band.kernel);
  // Waits for an unknown kernel before the next band.
  const double expected_s = known == thread_seconds_.end() ? kQueueSeconds : known->second * threads;
  device_.launch(band);
  bands_.push_back({std::string(band.name), std::string(band.kernel), threads, expected_s});
  expected_s_ += expected_s;
}

void DeviceQueue::make_room() {
  collect_times();
  while (!bands_.empty() && expected_s_ >= kQueueSeconds) {
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
    double& thread_s = thread_seconds_[band.kernel];
    thread_s = std::max(seconds / band.threads, kDecay * thread_s);
  }
}

void DeviceQueue::finish() {
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
  } catch (...) {  // the queue is empty after any error
  }
  bands_.clear();
  expected_s_ = 0;
}

uint64_t DeviceQueue::band_threads(std::string_view kernel) const {
  const uint64_t least = device_.parallel_threads();
  const auto known = thread_seconds_.find(kernel);
  if (known == thread_seconds_.end() || known->second <= 0) return least;
  return std::max(least, static_cast<uint64_t>(std::min(kBandSeconds / known->second, 1e15)));
}

}  // namespace relume
