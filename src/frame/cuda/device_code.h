// The compiled code of all kernels.
#pragma once

#include <cstddef>
#include <string>

namespace relume {

/// PTX with an entry for each kernel (frame/cuda/device_entry.h). Inflates the copy in the library; empty if the build
/// found no compiler for device code (RELUME_CUDA).
std::string device_code();

/// Bytes of the copy in the library, which is compressed.
size_t device_code_bytes();

}  // namespace relume
