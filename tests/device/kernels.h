// Device code of the library and of tests, translated to C++.
#pragma once

#include "runtime/module.h"

namespace ptx {

/// All kernels of the library.
extern const Module all_kernels;
/// One of them, compiled with fused multiply-adds.
extern const Module contracted;
/// The kernel in small_numbers.h.
extern const Module small_numbers;
/// Kernels of primitives that only tests launch.
extern const Module primitives;

}  // namespace ptx
