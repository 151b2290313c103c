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
    case Result::contained:
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
    case Result::tensor_memory_leak:
    case Result::mps_client_terminated:
    case Result::external_device:
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
    create_objects();
  } catch (...) {
    destroy_objects();
    driver_.cuDevicePrimaryCtxRelease(device_);
    throw;
  }
}

Queue::~Queue() {
  destroy_objects();
  driver_.cuDevicePrimaryCtxRelease(device_);
}

void Queue::create_objects() {
  const Current current(*this);
  check(driver_.cuStreamCreate(&stream_, kStreamNonBlocking), "creating a queue");
  check(driver_.cuEventCreate(&reached_, kEventBlockingSync), "creating an event");
}

void Queue::destroy_objects() const {
  free_objects([&] {
    if (!stream_) return;
    driver_.cuStreamSynchronize(stream_);
    if (reached_) driver_.cuEventDestroy(reached_);
    driver_.cuStreamDestroy(stream_);
  });
}

void Queue::launched(std::string_view name) {
  const std::lock_guard lock(mutex_);
  launches_.emplace_back(name);
}

void Queue::oldest_ended() {
  const std::lock_guard lock(mutex_);
  if (!launches_.empty()) launches_.pop_front();
}

void Queue::all_ended() {
  const std::lock_guard lock(mutex_);
  launches_.clear();
}

void Queue::finish() {
  check_usable();
  const uint64_t added = added_.load();
  uint64_t finished = finished_.load();
  if (finished >= added) return;
  submit();
  wait_for_stream("executing kernels");
  while (finished < added && !finished_.compare_exchange_weak(finished, added)) {
  }
}

void Queue::wait_for_stream(std::string_view action) {
  check(driver_.cuEventRecord(reached_, stream_), action);
  check(driver_.cuEventSynchronize(reached_), action);
}

void Queue::check(Result result, std::string_view action) {
  if (result != Result::success) fail(result, action);
}

bool Queue::accepts(Result result, std::string_view action) {
  if (ends_context(result)) fail(result, action);
  return result == Result::success;
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
  // The host does not know which of the queued launches have ended.
  const std::string where = launches_.empty() ? "" : fmt::format(" in or after the launch of '{}'", launches_.front());
  failure_ = fmt::format("{} failed{}: {}; {}", device_name_, where, text, remedy(result));
  failed_.store(true);
  throw Error(ErrorCode::device, failure_);
}

}  // namespace relume::cuda
