// Errors: a code for programs and a sentence for users.
#pragma once

#include <new>
#include <stdexcept>
#include <string>

#include "relume/export.h"

namespace relume {

/// Kinds of errors.
enum class ErrorCode {
  invalid_input,   ///< a file, setting, value or combination that cannot be used
  invalid_handle,  ///< a handle of a removed object or of another session
  not_found,       ///< a file, camera, setting or layer that does not exist
  not_supported,   ///< valid, but not supported by this build
  io,              ///< a failed read or write
  device,          ///< a GPU or driver that is missing, cannot be used, or failed
};

/// Thrown for unusable input and for devices that fail, never inside kernels. `what()` is one sentence that names the
/// location (file, line, setting), the problem and the remedy. The program prints it and exits with a non-zero code.
class RELUME_API Error : public std::runtime_error {
 public:
  explicit Error(const std::string& message) : std::runtime_error(message) {}
  Error(ErrorCode code, const std::string& message) : std::runtime_error(message), code_(code) {}

  ErrorCode code() const { return code_; }

 private:
  ErrorCode code_ = ErrorCode::invalid_input;
};

/// Thrown where a device has too little memory. `what()` is one sentence as of Error. Handlers of std::bad_alloc catch
/// it, so that it has no code.
class RELUME_API DeviceMemoryError : public std::bad_alloc {
 public:
  explicit DeviceMemoryError(const std::string& message) : message_(message) {}

  const char* what() const noexcept override { return message_.what(); }

 private:
  std::runtime_error message_;  // its copies, which exceptions need, do not throw
};

}  // namespace relume
