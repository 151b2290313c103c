// Runs work on another thread while the calling Python thread handles signals, so that Ctrl-C ends it.
#pragma once

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <stop_token>
#include <string>
#include <thread>

#include <sys/types.h>

#include <pybind11/pybind11.h>

namespace relume::python {

namespace py = pybind11;

/// A thread that executes one piece of work at a time.
class Worker {
 public:
  Worker();
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  using Work = std::function<void(const std::stop_token&)>;
  /// Calls `work` on the thread and waits for its end. Call with the GIL, which is released meanwhile. A signal whose
  /// Python handler raises (Ctrl-C: KeyboardInterrupt), or a true result of `wants_stop`, requests a stop. Both are
  /// checked every 20 ms, `wants_stop` also before the work. Rethrows exceptions of the handlers and of `work`. Throws
  /// Error in a process that was forked after the construction.
  void run(const Work& work, const py::object& wants_stop);

  /// Calls a Python function with `argument` in the work, with the GIL. An interruption raises KeyboardInterrupt in it.
  void call(const py::object& function, const std::string& argument);

  /// Whether this process was forked after the construction. It lacks the thread, so it cannot destroy the worker.
  bool is_forked() const;
  bool is_this_thread() const { return std::this_thread::get_id() == thread_.get_id(); }

 private:
  void loop();
  /// Runs handlers of signals and asks `wants_stop`. Sets `interruption` to what they raise, and requests a stop.
  void poll(const py::object& wants_stop, bool handles_signals, std::exception_ptr& interruption);

  std::mutex mutex_;
  std::condition_variable changed_;
  const Work* work_ = nullptr;
  std::stop_source stop_;
  std::exception_ptr failure_;
  unsigned long python_thread_ = 0;  ///< identifier of the thread while it calls a function; guarded by the GIL
  bool ends_ = false;
  pid_t process_;
  std::thread thread_;
};

/// Call when the interpreter is about to end: threads that Python does not wait for then stop in run() for good, because
/// they could not take the GIL any more.
void end_workers();

}  // namespace relume::python
