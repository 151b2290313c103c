// The state behind relume.Session.
#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "images.h"
#include "interruptible.h"
#include "relume/session.h"

namespace relume::python {

/// A session whose frames render on a thread of its own. The GIL protects the members. While a call has released the GIL,
/// only hooks on the rendering thread may use the session.
class PythonSession {
 public:
  PythonSession(Scene scene, const Settings& settings, std::vector<Index> movable)
      : session_(std::make_unique<Session>(std::move(scene), settings, std::move(movable))) {}
  ~PythonSession();
  PythonSession(const PythonSession&) = delete;
  PythonSession& operator=(const PythonSession&) = delete;

  /// For reading. Throws Error while another thread uses the session.
  const Session& read() const {
    check_access();
    return *session_;
  }
  /// For changes that hooks may make, too: buffers and the shown image.
  Session& edit() {
    check_access();
    image_ = nullptr;
    return *session_;
  }
  /// For all other changes. Session throws Error if a hook makes them.
  Session& change() { return edit(); }

  /// Runs `work` on the session's thread, as Worker::run() does. Throws Error while another call runs.
  void run(const Worker::Work& work, const py::object& wants_stop);
  /// Calls `work` without the GIL on this thread.
  void run_here(const std::function<void()>& work);

  /// The image of the last frame: one copy per frame, however often it is read.
  std::shared_ptr<const Image> image() {
    check_access();
    if (busy_) return session_->snapshot();  // in a hook, the frame may change
    if (!image_) image_ = session_->snapshot();
    return image_;
  }

  /// Calls a hook with the GIL. Ctrl-C interrupts it.
  void call_hook(const py::object& function, const std::string& pass) { worker_->call(function, pass); }

 private:
  void check_access() const;

  std::unique_ptr<Session> session_;
  std::shared_ptr<const Image> image_;
  bool busy_ = false;  ///< whether a call has released the GIL
  std::unique_ptr<Worker> worker_ = std::make_unique<Worker>();
};

/// Declared in define_session(), extended in define_session_edits().
using SessionClass = py::class_<PythonSession>;

}  // namespace relume::python
