// The CUDA backend on the stub driver: launches, order, times, arguments.
#include "frame/cuda/cuda_device.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/activity.h"
#include "core/array.h"
#include "kernels.h"
#include "launch_kernel.h"
#include "relume/error.h"
#include "stub_driver.h"

namespace relume::cuda {
namespace {

using testing::AddKernel;
using testing::AppendKernel;
using testing::CountKernel;
using testing::PositionKernel;
using testing::queue;
using testing::RowSumKernel;
using testing::StubDriver;

/// Runs with work that is executed at once, or when the host waits for it; with and without concurrent access.
class CudaDeviceTest : public ::testing::TestWithParam<std::string> {
 protected:
  StubDriver stub_{GetParam()};
  std::unique_ptr<Device> device_ = open_device(stub_.driver(), testing::test_device_code());
};

TEST_P(CudaDeviceTest, RunsPassKernelsOnLists) {
  Array<uint32_t> values(device_->memory());
  values.assign(1000, 5);
  queue(*device_, AddKernel{3, values.mutable_view()}, {10, 0, 990, 1});
  device_->finish();
  const std::span<const uint32_t> result = values.read();
  for (uint32_t i = 0; i < result.size(); ++i) ASSERT_EQ(result[i], i >= 10 && i < 990 ? 8u : 5u) << i;
}

TEST_P(CudaDeviceTest, RunsPassKernelsOnWindowsOfImages) {
  constexpr uint32_t kWidth = 50;
  constexpr uint32_t kHeight = 40;
  Array<uint32_t> image(device_->memory());
  image.assign(size_t{kWidth} * kHeight, 9);
  queue(*device_, PositionKernel{image.mutable_view(), kWidth}, {3, 5, 49, 38});
  const std::span<const uint32_t> result = image.read();
  for (uint32_t y = 0; y < kHeight; ++y) {
    for (uint32_t x = 0; x < kWidth; ++x) {
      const bool inside = x >= 3 && x < 49 && y >= 5 && y < 38;
      ASSERT_EQ(result[y * kWidth + x], inside ? y * 1000 + x : 9) << x << " " << y;
    }
  }
}

TEST_P(CudaDeviceTest, FillsItsBlocksWithElements) {
  Array<uint32_t> image(device_->memory());
  for (const Tile& window : {Tile{0, 0, 256, 1}, Tile{0, 0, 1, 256}, Tile{0, 0, 16, 16}}) {
    const ElementBlock block = device_->block(window);
    EXPECT_EQ(block.width * block.height, 128u);
    EXPECT_LE(block.width, window.width());
    EXPECT_LE(block.height, window.height());
    image.assign(256, 0);
    queue(*device_, PositionKernel{image.mutable_view(), window.width()}, window);
    device_->finish();
    EXPECT_NEAR(device_->take_times().at(0), 256e-6, 1e-7) << "two blocks of 128 threads";
    EXPECT_EQ(image.read()[255], (window.height() - 1) * 1000 + window.width() - 1);
  }
}

TEST_P(CudaDeviceTest, RunsGroupKernels) {
  Array<uint32_t> values(device_->memory());
  Array<uint32_t> sums(device_->memory());
  values.reset(5 * 128);
  sums.assign(5, 0);
  const std::span<uint32_t> numbers = values.write();
  for (uint32_t i = 0; i < numbers.size(); ++i) numbers[i] = i;
  queue(*device_, RowSumKernel{values.view(), sums.mutable_view()}, {7, 1, 8, 5});
  const std::span<const uint32_t> result = sums.read();
  EXPECT_EQ(result[0], 0u) << "outside the window";
  for (uint32_t y = 1; y < 5; ++y) EXPECT_EQ(result[y], y * 128 * 128 + 127 * 64 + 7) << y;
}

TEST_P(CudaDeviceTest, KeepsTheOrderAndTheArgumentsOfManyLaunches) {
  constexpr uint64_t kLaunches = 300;
  Array<uint64_t> values(device_->memory());
  values.assign(3, 1);
  uint64_t expected = 1;
  for (uint64_t i = 0; i < kLaunches; ++i) {
    queue(*device_, AppendKernel{values.mutable_view(), i}, {0, 0, 3, 1});
    expected = expected * 31 + i;
  }
  for (const uint64_t value : values.read()) EXPECT_EQ(value, expected);
  EXPECT_EQ(StubDriver::calls("cuMemcpyHtoDAsync_v2"), kLaunches);
}

TEST_P(CudaDeviceTest, CopiesTheSameArgumentOnce) {
  Array<uint32_t> values(device_->memory());
  values.assign(100, 0);
  const AddKernel kernel{1, values.mutable_view()};
  for (uint32_t i = 0; i < 100; i += 10) queue(*device_, kernel, {i, 0, i + 10, 1});
  EXPECT_EQ(StubDriver::calls("cuMemcpyHtoDAsync_v2"), 1u);
  queue(*device_, AddKernel{2, values.mutable_view()}, {0, 0, 100, 1});
  EXPECT_EQ(StubDriver::calls("cuMemcpyHtoDAsync_v2"), 2u);
  for (const uint32_t value : values.read()) EXPECT_EQ(value, 3u);
}

TEST_P(CudaDeviceTest, TimesLaunchesInOrder) {
  Array<uint32_t> values(device_->memory());
  values.assign(20000, 0);
  for (const uint32_t size : {1u, 20000u, 2u}) queue(*device_, AddKernel{1, values.mutable_view()}, {0, 0, size, 1});
  device_->wait(1);
  std::vector<double> times = device_->take_times();
  EXPECT_GE(times.size(), 2u);
  device_->finish();
  for (const double time : device_->take_times()) times.push_back(time);
  ASSERT_EQ(times.size(), 3u);
  // The stub takes 1 µs for each thread, of 128 in a block.
  EXPECT_NEAR(times[0], 128e-6, 1e-7);
  EXPECT_NEAR(times[1], 157 * 128e-6, 1e-7);
  EXPECT_NEAR(times[2], 128e-6, 1e-7);
  EXPECT_TRUE(device_->take_times().empty());
}

TEST_P(CudaDeviceTest, ProceedsWhileTheHostAsksForTimes) {
  Array<uint32_t> values(device_->memory());
  values.assign(1, 0);
  queue(*device_, AddKernel{1, values.mutable_view()}, {0, 0, 1, 1});
  size_t times = 0;
  for (int i = 0; i < 100 && times == 0; ++i) times = device_->take_times().size();
  EXPECT_EQ(times, 1u);
}

TEST_P(CudaDeviceTest, FreesAllObjects) {
  {
    Array<uint32_t> values(device_->memory());
    values.assign(100, 0);
    queue(*device_, AddKernel{1, values.mutable_view()}, {0, 0, 100, 1});
  }
  device_->finish();
  EXPECT_EQ(StubDriver::objects("managed"), 0u);
  device_.reset();
  EXPECT_EQ(StubDriver::objects("contexts"), 0u);
  EXPECT_EQ(StubDriver::objects("leaked"), 0u);
}

TEST_P(CudaDeviceTest, StatesItsThreads) { EXPECT_EQ(device_->parallel_threads(), 256u); }

TEST_P(CudaDeviceTest, RunsEachElementOfTheLastWindowOnce) {
  Array<uint32_t> counts(device_->memory());
  counts.assign(64, 0);
  constexpr uint32_t kFirst = 0xffffffc0;
  const CountKernel kernel{counts.mutable_view()};
  queue(*device_, kernel, {kFirst, 0, kFirst + 63, 1});
  queue(*device_, kernel, {0, kFirst, 1, kFirst + 63});
  const std::span<const uint32_t> result = counts.read();
  for (uint32_t i = 0; i < 64; ++i) EXPECT_EQ(result[i], i < 63 ? 2u : 0u) << i;
}

TEST_P(CudaDeviceTest, TimesMovesOfMemory) {
  Array<uint32_t> large(device_->memory());
  large.assign(100000, 0);
  const AddKernel kernel{1, large.mutable_view()};
  for (int i = 0; i < 2; ++i) queue(*device_, kernel, {0, 0, 100, 1});
  device_->finish();
  EXPECT_EQ(device_->take_times().size(), 2u);
  const bool moves = GetParam().find("concurrent=0") == std::string::npos;
  EXPECT_NEAR(device_->take_move_time(), moves ? 4e-5 : 0, 1e-9) << "the stub takes 0.1 ns for a byte";
  EXPECT_EQ(device_->take_move_time(), 0);
}

TEST(CudaDevice, DividesWindowsThatAreTallerThanAGrid) {
  const StubDriver stub;
  const std::unique_ptr<Device> device = open_device(stub.driver(), testing::test_device_code());
  constexpr uint32_t kHeight = 65535 * 16 + 5;
  Array<uint32_t> image(device->memory());
  image.assign(2 * kHeight, 0);
  queue(*device, PositionKernel{image.mutable_view(), 2}, {0, 0, 2, kHeight});
  EXPECT_EQ(StubDriver::calls("cuLaunchKernel"), 2u);
  device->finish();
  EXPECT_EQ(device->take_times().size(), 1u);
  const std::span<const uint32_t> result = image.read();
  for (uint32_t y = 0; y < kHeight; ++y) ASSERT_EQ(result[2 * y + 1], y * 1000 + 1) << y;
}

TEST(CudaDevice, ShowsThatTheDriverCompiles) {
  static decltype(Driver::cuModuleLoadDataEx) compile;
  static std::optional<std::string> shown;
  const StubDriver stub;
  Driver driver = stub.driver();
  compile = driver.cuModuleLoadDataEx;
  driver.cuModuleLoadDataEx = [](Module* module, const void* image, unsigned options, CompilerOption* names,
                                 void** values) {
    shown = current_activity();
    return compile(module, image, options, names, values);
  };
  open_device(driver, testing::test_device_code());
  EXPECT_EQ(shown.value_or(""), "waiting for the driver to compile kernels for Stub GPU 0 (cuda:0)");
  EXPECT_FALSE(current_activity().has_value());
}

INSTANTIATE_TEST_SUITE_P(Drivers, CudaDeviceTest,
                         ::testing::Values("", "eager=1", "concurrent=0", "eager=1 concurrent=0", "seed=7"),
                         [](const auto& tested) {
                           std::string name = tested.param.empty() ? "deferred" : tested.param;
                           std::replace(name.begin(), name.end(), ' ', '_');
                           std::erase(name, '=');
                           return name;
                         });

}  // namespace
}  // namespace relume::cuda
