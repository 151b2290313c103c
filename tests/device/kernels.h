// The device code of the library, translated to C++.
#pragma once

#include "runtime/module.h"

namespace ptx {

/// All kernels.
extern const Module all_kernels;
/// One of them, compiled with fused multiply-adds.
extern const Module contracted;

}  // namespace ptx
