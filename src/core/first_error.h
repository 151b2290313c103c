// Steps that all run, even if one of them throws.
#pragma once

#include <exception>

namespace relume {

/// Keeps the first of several exceptions.
class FirstError {
 public:
  /// Keeps the exception that is being handled, if it is the first.
  void add_current() noexcept {
    if (!error_) error_ = std::current_exception();
  }
  /// Calls `step` and keeps its exception, if it is the first.
  template <typename F>
  void attempt(const F& step) noexcept {
    try {
      step();
    } catch (...) {
      add_current();
    }
  }
  bool any() const { return error_ != nullptr; }
  /// Throws the first exception, if any.
  void rethrow() const {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::exception_ptr error_;
};

}  // namespace relume
