// The stub driver for tests: it is loaded as the system's driver, from LD_LIBRARY_PATH.
#pragma once

#include <cstddef>
#include <string>

#include "frame/cuda/driver.h"

namespace relume::cuda::testing {

/// The stub's settings (stub/control.h) for its lifetime.
class StubDriver {
 public:
  /// Loads a driver with these settings. Throws Error as load_driver(), and std::runtime_error if libcuda.so.1 is not
  /// the stub.
  explicit StubDriver(const std::string& settings = "");
  ~StubDriver();
  StubDriver(const StubDriver&) = delete;
  StubDriver& operator=(const StubDriver&) = delete;

  const Driver& driver() const { return driver_; }

  /// Other settings for the same driver.
  static void configure(const std::string& settings);
  static size_t objects(const char* kind);
  static size_t calls(const char* function);
  /// A texture of OpenGL, and its content.
  static void make_texture(unsigned name, size_t row_bytes, size_t rows);
  static const void* texture(unsigned name);

 private:
  Driver driver_;
};

/// The PTX of kernels.cu.
std::string test_device_code();

}  // namespace relume::cuda::testing
