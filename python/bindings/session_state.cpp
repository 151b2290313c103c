#include "session_state.h"

#include "relume/error.h"

namespace relume::python {
namespace {

/// Marks the session as busy, and the image as outdated.
class Use {
 public:
  explicit Use(bool& busy) : busy_(busy) { busy_ = true; }
  ~Use() { busy_ = false; }
  Use(const Use&) = delete;
  Use& operator=(const Use&) = delete;

 private:
  bool& busy_;
};

}  // namespace

PythonSession::~PythonSession() {
  if (!worker_->is_forked()) return;
  // A forked process lacks the threads for which the destructors would wait.
  session_.release();
  worker_.release();
}

void PythonSession::check_access() const {
  if (!busy_ || worker_->is_this_thread()) return;
  throw Error("another thread uses the session; wait for its end, or stop it (a live view: view.stop())");
}

void PythonSession::run(const Worker::Work& work, const py::object& wants_stop) {
  check_access();
  if (busy_) throw Error("a hook cannot render with the session that runs it; render between frames");
  const Use use(busy_);
  image_ = nullptr;
  worker_->run(work, wants_stop);
}

void PythonSession::run_here(const std::function<void()>& work) {
  check_access();
  if (busy_) throw Error("a hook cannot read or write checkpoints; do so between frames");
  const Use use(busy_);
  image_ = nullptr;
  const py::gil_scoped_release released;
  work();
}

}  // namespace relume::python
