// Tests that the emulated device keeps denormal numbers, with the bits of the host.
#include "device/small_numbers.h"

#include <gtest/gtest.h>

#include <cstring>
#include <span>
#include <vector>

#include "core/array.h"
#include "core/denormals.h"
#include "device/emulated_device.h"
#include "device/kernels.h"
#include "frame/launch.h"
#include "testing/walled_memory.h"

namespace relume::testing {
namespace {

/// Denormal numbers, and normal ones whose sums, products and quotients are denormal. Without zeros, whose quotient is
/// NaN.
std::vector<float> operands() {
  std::vector<float> values;
  for (const float x : {0x1p-149f, 0x3p-149f, 0x1p-127f, 0x1.fffffcp-127f, 0x1p-126f, 0x1.000002p-126f, 0x1.8p-125f,
                        1e-30f, 1e-20f, 0x1p-24f, 0.7f, 1.0f, 3.0f, 0x1p23f, 0x1.8p127f}) {
    values.push_back(x);
    values.push_back(-x);
  }
  return values;
}

using Results = std::vector<SmallNumberResults>;

/// The results of SmallNumbersKernel for all pairs of operands.
Results results_of(Backend& backend) {
  Array<float> values(backend.memory());
  values.assign(operands());
  Array<SmallNumberResults> results(backend.memory());
  results.reset(values.size() * values.size());
  const auto count = static_cast<uint32_t>(values.size());
  launch(backend, "small numbers", SmallNumbersKernel{values.view(), results.mutable_view()}, count, count);
  const std::span<const SmallNumberResults> computed = results.read();
  return {computed.begin(), computed.end()};
}

Results results_of_host(Denormals mode) {
  Backend backend(1, KernelForm::host, host_memory(), mode);
  return results_of(backend);
}

/// `caller`: mode of the thread that waits for the device.
Results results_of_device(Denormals caller) {
  WalledMemory walls;
  EmulatedDevice device(walls, {&ptx::small_numbers});
  Backend backend(device, 1);
  const DenormalMode mode_of_caller(caller);
  return results_of(backend);
}

/// Whether the bits of two results are equal.
bool same(const SmallNumberResults& a, const SmallNumberResults& b) { return std::memcmp(&a, &b, sizeof(a)) == 0; }

TEST(SmallNumbers, HaveTheSameBitsOnTheEmulatedDevice) {
  const std::vector<float> values = operands();
  const Results expected = results_of_host(Denormals::keep);
  for (const Denormals caller : {Denormals::keep, Denormals::flush}) {
    const Results computed = results_of_device(caller);
    ASSERT_EQ(computed.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i) {
      EXPECT_TRUE(same(computed[i], expected[i]))
          << "a = " << values[i / values.size()] << ", b = " << values[i % values.size()];
    }
  }
}

/// The comparison notices flushed numbers.
TEST(SmallNumbers, AreFlushedToOtherBits) {
  const Results kept = results_of_host(Denormals::keep);
  const Results flushed = results_of_host(Denormals::flush);
  // 0x1p-127f with itself.
  const size_t i = 4 * operands().size() + 4;
  EXPECT_EQ(kept[i].sum, 0x1p-126f);
  EXPECT_EQ(kept[i].product, 0.0f) << "less than the smallest denormal number";
  EXPECT_EQ(kept[i].quotient, 1.0f);
  EXPECT_EQ(kept[i].scaled, 0x1p-1027);
  EXPECT_FALSE(same(flushed[i], kept[i]));
}

}  // namespace
}  // namespace relume::testing
