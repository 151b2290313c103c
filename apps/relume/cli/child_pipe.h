// A child program that reads from a pipe.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace relume::cli {

class ChildPipe {
 public:
  /// Starts `arguments[0]`, found in PATH, with a pipe as its standard input. Throws Error if the start fails.
  explicit ChildPipe(const std::vector<std::string>& arguments);
  /// Terminates the program if finish() was not called.
  ~ChildPipe();
  ChildPipe(const ChildPipe&) = delete;
  ChildPipe& operator=(const ChildPipe&) = delete;

  /// Returns false if the program has stopped reading.
  bool write(const void* data, size_t bytes);

  /// Closes the pipe, waits, and returns the exit code (or 128 + signal).
  int finish();

 private:
  int pipe_ = -1;
  int child_ = -1;
};

/// Whether PATH holds a program of that name.
bool program_exists(const std::string& name);

}  // namespace relume::cli
