// The emulated device, for the tests of primitives.
#include <gtest/gtest.h>

#include <string>

#include "device/emulated_device.h"
#include "device/kernels.h"
#include "frame/primitives/testing/backends.h"
#include "testing/walled_memory.h"

namespace relume::testing {

void for_each_backend(const std::function<void(const PrimitiveLaunch&)>& test) {
  WalledMemory walls;
  walls.end_launch();
  EmulatedDevice device(walls, {&ptx::primitives, &ptx::all_kernels});
  Backend backend(device, 2);
  // Kernels must not hold addresses outside of the device's memory.
  backend.on_launch([&](const LaunchEvent& event) {
    if (event.kind == LaunchEvent::Kind::kernel) walls.check_kernel(event.name, event.argument);
  });
  PrimitiveScratch scratch;
  test(PrimitiveLaunch{backend, "test", scratch});
  for (const std::string& violation : walls.violations()) ADD_FAILURE() << violation;
}

}  // namespace relume::testing
