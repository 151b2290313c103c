// The backends of the tests of primitives. A test program links one definition: the forms of the host
// (host_backends.cpp), or the emulated device (tests/device/emulated_backends.cpp).
#pragma once

#include <functional>

#include "frame/primitives/primitive.h"

namespace relume::testing {

/// Calls test(launch) with every backend of the program. Arrays that kernels access take the memory of its backend.
void for_each_backend(const std::function<void(const PrimitiveLaunch&)>& test);

}  // namespace relume::testing
