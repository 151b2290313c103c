// main() of image tests whose sessions run on the emulated device. The same tests with another main() run on the host.
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "device/emulated_device.h"
#include "device/kernels.h"
#include "render/session.h"
#include "testing/walled_memory.h"

int main(int argc, char** argv) {
  using relume::testing::EmulatedDevice;
  constexpr int kSkipped = 77;
  ::testing::InitGoogleTest(&argc, argv);
  // Outlives sessions in static variables of tests. It stays open to the host: DeviceBits watches accesses.
  static relume::testing::WalledMemory walls;
  static std::atomic<uint32_t> devices = 0;
  relume::replace_host([] {
    // Each device runs blocks and threads in an order of its own.
    return std::make_unique<EmulatedDevice>(walls, std::vector<const ptx::Module*>{&ptx::all_kernels}, ++devices);
  });
  const int result = RUN_ALL_TESTS();
  if (result != 0 || devices > 0 || GTEST_FLAG_GET(list_tests)) return result;
  std::puts("Skipped: no session ran on the emulated device");
  return kSkipped;
}
