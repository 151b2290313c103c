// What went wrong with the user's input: one sentence with place and remedy.
#pragma once

#include <stdexcept>
#include <string>

namespace relume {

/// Thrown at the edges (io, apps, settings) for input that cannot be used. `what()` is one sentence that
/// names the place (file, line, setting), the problem and the remedy; the program prints it and exits
/// with a non-zero code. Never thrown inside kernels.
class Error : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace relume
