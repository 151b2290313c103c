#include "frame/cuda/queue.h"

#include <utility>

#include <fmt/format.h>

#include "relume/error.h"

namespace relume::cuda {
namespace {

/// Whether every later call in the context returns the error, too.
bool ends_context(Result result) {
  switch (result) {
    case Result::ecc_uncorrectable:
    case Result::nvlink_uncorrectable:
    case Result::illegal_address:
    case Result::launch_timeout:
    case Result::context_is_destroyed:
    case Result::device_assert:
    case Result::hardware_stack_error:
    case Result::illegal_instruction:
    case Result::misaligned_address:
    case Result::invalid_address_space:
    case Result::invalid_pc:
    case Result::launch_failed:
    case Result::unknown: return true;
    default: return false;
  }
}

}  // namespace

Queue::Current::Current(const Queue& queue) : queue_(queue) {
  queue.check_usable();
  const Result result = queue.driver_.cuCtxPushCurrent(queue.context_);
  cuda::check(queue.driver_, result, "using " + queue.device_name_);
}

Queue::Current::~Current() {
  Context popped = nullptr;
  queue_.driver_.cuCtxPopCurrent(&popped);
}

Queue::Queue(const Driver& driver, DeviceNumber device, std::string device_name)
    : driver_(driver), device_(device), device_name_(std::move(device_name)) {
  cuda::check(driver_, driver_.cuDevicePrimaryCtxRetain(&context_, device_), "starting " + device_name_);
  try {
    const Current current(*this);
    check(driver_.cuStreamCreate(&stream_, kStreamNonBlocking), "creating a queue");
  } catch (...) {
    driver_.cuDevicePrimaryCtxRelease(device_);
    throw;
  }
}

Queue::~Queue() {
  free_objects([&] {
    driver_.cuStreamSynchronize(stream_);
    driver_.cuStreamDestroy(stream_);
  });
  driver_.cuDevicePrimaryCtxRelease(device_);
}

void Queue::added(std::string_view name) {
  {
    const std::lock_guard lock(mutex_);
    last_launch_ = name;
  }
  ++added_;
}

void Queue::finish() {
  check_usable();
  const uint64_t added = added_.load();
  uint64_t finished = finished_.load();
  if (finished >= added) return;
  check(driver_.cuStreamSynchronize(stream_), "executing kernels");
  while (finished < added && !finished_.compare_exchange_weak(finished, added)) {
  }
}

void Queue::check(Result result, std::string_view action) {
  if (result != Result::success) fail(result, action);
}

void Queue::check_usable() const {
  if (!failed_.load()) return;
  const std::lock_guard lock(mutex_);
  throw Error(ErrorCode::device, failure_);
}

void Queue::fail(Result result, std::string_view action) {
  check_usable();
  const std::string text = describe(driver_, result);
  if (result == Result::out_of_memory) {
    throw DeviceMemoryError(
        fmt::format("{}: {} failed: {}; {}", device_name_, action, text, remedy(Result::out_of_memory)));
  }
  if (!ends_context(result)) {
    throw Error(ErrorCode::device, fmt::format("{}: {} failed: {}; {}", device_name_, action, text, remedy(result)));
  }
  const std::lock_guard lock(mutex_);
  failure_ =
      fmt::format("{} failed after the launch of '{}': {}; {}", device_name_, last_launch_, text, remedy(result));
  failed_.store(true);
  throw Error(ErrorCode::device, failure_);
}

}  // namespace relume::cuda
