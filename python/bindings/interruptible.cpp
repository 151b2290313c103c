#include "interruptible.h"

#include <atomic>
#include <chrono>
#include <utility>

#include <unistd.h>

#include "relume/error.h"

namespace relume::python {
namespace {

constexpr std::chrono::milliseconds kPollInterval(20);

/// Whether the interpreter is about to end.
std::atomic<bool> interpreter_ends{false};

/// Whether this is the thread that handles signals. Call with the GIL.
bool is_main_thread() {
  const py::module_ threading = py::module_::import("threading");
  return threading.attr("current_thread")().is(threading.attr("main_thread")());
}

}  // namespace

void end_workers() { interpreter_ends = true; }

Worker::Worker() : process_(getpid()), thread_([this] { loop(); }) {}

bool Worker::is_forked() const { return process_ != getpid(); }

Worker::~Worker() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  // The thread never waits for the GIL here: its work has ended.
  thread_.join();
}

void Worker::loop() {
  std::unique_lock lock(mutex_);
  for (;;) {
    changed_.wait(lock, [&] { return ends_ || work_ != nullptr; });
    if (ends_) return;
    const Work* work = work_;
    const std::stop_token stop = stop_.get_token();
    lock.unlock();
    std::exception_ptr failure;
    try {
      (*work)(stop);
    } catch (...) {
      failure = std::current_exception();
    }
    lock.lock();
    failure_ = std::move(failure);  // the last owner of a Python exception needs the GIL to release it
    work_ = nullptr;
    changed_.notify_all();
  }
}

void Worker::run(const Work& work, const py::object& wants_stop) {
  if (is_forked()) {
    throw Error(ErrorCode::not_supported,
                "the session belongs to the process from which this one was forked; create it in this process, or use "
                "multiprocessing's start method 'spawn'");
  }
  if (!wants_stop.is_none() && py::bool_(wants_stop())) return;
  // Other threads take the GIL only to ask `wants_stop`: at the interpreter's end they could not.
  const bool handles_signals = is_main_thread();
  const bool polls = handles_signals || !wants_stop.is_none();
  std::exception_ptr interruption;
  std::exception_ptr failure;
  {
    const py::gil_scoped_release released;
    std::unique_lock lock(mutex_);
    stop_ = std::stop_source();
    work_ = &work;
    changed_.notify_all();
    while (!changed_.wait_for(lock, kPollInterval, [&] { return work_ == nullptr; })) {
      if (interpreter_ends) stop_.request_stop();
      if (!polls || stop_.stop_requested()) continue;
      lock.unlock();
      poll(wants_stop, handles_signals, interruption);
      lock.lock();
    }
    failure = std::exchange(failure_, nullptr);
    lock.unlock();
    while (interpreter_ends) std::this_thread::sleep_for(std::chrono::hours(1));
  }
  if (interruption) std::rethrow_exception(interruption);
  if (failure) std::rethrow_exception(failure);
}

void Worker::poll(const py::object& wants_stop, bool handles_signals, std::exception_ptr& interruption) {
  const py::gil_scoped_acquire acquired;
  try {
    if (handles_signals && PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!wants_stop.is_none() && py::bool_(wants_stop())) stop_.request_stop();
  } catch (py::error_already_set&) {
    interruption = std::current_exception();
    stop_.request_stop();
    if (python_thread_ != 0) PyThreadState_SetAsyncExc(python_thread_, PyExc_KeyboardInterrupt);
  }
}

void Worker::call(const py::object& function, const std::string& argument) {
  const py::gil_scoped_acquire acquired;
  python_thread_ = PyThread_get_thread_ident();
  try {
    function(argument);
  } catch (...) {
    python_thread_ = 0;
    throw;
  }
  python_thread_ = 0;
}

}  // namespace relume::python
