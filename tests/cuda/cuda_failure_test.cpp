// Failures of the CUDA backend on the stub driver: devices that fail during a frame, code that does not fit, errors at
// every step of opening a device.
#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/array.h"
#include "frame/cuda/cuda_device.h"
#include "kernels.h"
#include "launch_kernel.h"
#include "relume/error.h"
#include "stub_driver.h"

namespace relume::cuda {
namespace {

using testing::AddKernel;
using testing::AppendKernel;
using testing::queue;
using testing::RowSumKernel;
using testing::StubDriver;
using testing::TrapKernel;

std::unique_ptr<Device> open(const StubDriver& stub) { return open_device(stub.driver(), testing::test_device_code()); }

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "no error";
}

constexpr const char* kLost =
    "Stub GPU 0 (cuda:0) failed after the launch of 'third': CUDA_ERROR_LAUNCH_FAILED (unspecified launch failure); "
    "start relume again, or use --device cpu";

/// A device that has failed in the second of three launches.
class LostCudaDeviceTest : public ::testing::Test {
 protected:
  LostCudaDeviceTest() {
    values_.assign(16, 0);
    for (const char* name : {"first", "second", "third"}) {
      queue(*device_, AddKernel{1, values_.mutable_view()}, {0, 0, 16, 1}, name);
    }
  }

  StubDriver stub_{"lose=2"};
  std::unique_ptr<Device> device_ = open(stub_);
  Array<uint32_t> values_{device_->memory()};
};

TEST_F(LostCudaDeviceTest, FailsForever) {
  EXPECT_EQ(error_of([&] { device_->finish(); }), kLost);
  EXPECT_EQ(error_of([&] { device_->finish(); }), kLost);
  EXPECT_EQ(error_of([&] { device_->wait(0); }), kLost);
  EXPECT_EQ(error_of([&] { device_->take_times(); }), kLost);
  EXPECT_EQ(error_of([&] { queue(*device_, AddKernel{1, values_.mutable_view()}, {0, 0, 16, 1}); }), kLost);
}

TEST_F(LostCudaDeviceTest, IsNoticedByTheMemory) {
  EXPECT_EQ(error_of([&] { values_.read(); }), kLost);
  EXPECT_EQ(error_of([&] { values_.write(); }), kLost);
  EXPECT_EQ(error_of([&] { Array<uint32_t>(device_->memory()).assign(5, 1); }), kLost);
}

TEST_F(LostCudaDeviceTest, IsNoticedByTimes) {
  EXPECT_EQ(error_of([&] {
              for (int i = 0; i < 100; ++i) device_->take_times();
            }),
            kLost);
}

TEST_F(LostCudaDeviceTest, CanBeOpenedAgain) {
  EXPECT_THROW(device_->finish(), Error);
  values_ = Array<uint32_t>();
  device_.reset();
  EXPECT_EQ(StubDriver::objects("contexts"), 0u);
  const std::unique_ptr<Device> again = open(stub_);
  Array<uint32_t> values(again->memory());
  values.assign(1, 0);
  queue(*again, AddKernel{1, values.mutable_view()}, {0, 0, 1, 1});
  EXPECT_EQ(values.read()[0], 1u);
}

TEST(CudaFailure, IsATrapOfAKernel) {
  const StubDriver stub;
  const std::unique_ptr<Device> device = open(stub);
  queue(*device, TrapKernel{}, {0, 0, 1, 1}, "trap");
  EXPECT_NE(error_of([&] { device->finish(); }).find("failed after the launch of 'trap'"), std::string::npos);
}

TEST(CudaFailure, OfALaunchIsSurvived) {
  const StubDriver stub("fail=cuLaunchKernel:2:2");
  const std::unique_ptr<Device> device = open(stub);
  Array<uint64_t> values(device->memory());
  values.assign(1, 0);
  queue(*device, AppendKernel{values.mutable_view(), 1}, {0, 0, 1, 1});
  const AppendKernel second{values.mutable_view(), 2};
  EXPECT_THROW(queue(*device, second, {0, 0, 1, 1}), DeviceMemoryError);
  queue(*device, second, {0, 0, 1, 1});
  EXPECT_EQ(values.read()[0], 33u);
  device->finish();
  EXPECT_EQ(device->take_times().size(), 2u);
}

TEST(CudaFailure, OfACopyIsSurvived) {
  const StubDriver stub("fail=cuMemcpyHtoDAsync_v2:2:1");
  const std::unique_ptr<Device> device = open(stub);
  Array<uint64_t> values(device->memory());
  values.assign(1, 0);
  queue(*device, AppendKernel{values.mutable_view(), 1}, {0, 0, 1, 1});
  const AppendKernel second{values.mutable_view(), 2};
  EXPECT_THROW(queue(*device, second, {0, 0, 1, 1}), Error);
  queue(*device, second, {0, 0, 1, 1});
  EXPECT_EQ(values.read()[0], 33u);
}

TEST(CudaFailure, IsCodeThatTheDriverRefuses) {
  const StubDriver stub;
  EXPECT_EQ(
      error_of([&] { open_device(stub.driver(), "no device code"); }),
      "Stub GPU 0 (cuda:0): compiling the kernels ('ptxas fatal   : Missing .version directive at start of file') "
      "failed: CUDA_ERROR_INVALID_PTX (a PTX JIT compilation failed); install a newer driver, or use --device "
      "cpu");
  EXPECT_EQ(error_of([&] { open_device(stub.driver(), ""); }),
            "this build of relume has no device code; build it with clang and RELUME_CUDA=ON, or use --device cpu");
}

TEST(CudaFailure, IsAGpuThatCannotBeUsed) {
  const StubDriver stub("capability=61");
  EXPECT_EQ(error_of([&] { open(stub); }),
            "Stub GPU 0 (cuda:0) cannot be used: its compute capability is 6.1, but relume needs 7.5; use another GPU "
            "or --device cpu");
}

TEST(CudaFailure, IsAKernelThatTheCodeLacks) {
  const StubDriver stub;
  const std::unique_ptr<Device> device = open(stub);
  const auto launch = [&](const DeviceLaunch& wanted) { return error_of([&] { device->launch(wanted); }); };
  const Tile window{0, 0, 1, 1};
  EXPECT_EQ(launch({"test", "relume::NoKernel", 0, {}, window}),
            "the device code has no kernel relume::NoKernel; add it to the kernels.inc of its folder");
  EXPECT_NE(launch({"test", kernel_type_name<RowSumKernel>(), 0, {}, window}).find("as a group kernel"),
            std::string::npos);
  EXPECT_NE(launch({"test", kernel_type_name<AddKernel>(), 64, {}, window}).find("as a pass kernel"),
            std::string::npos);
  const std::vector<std::byte> large(5000);
  EXPECT_NE(launch({"test", kernel_type_name<AddKernel>(), 0, large, window}).find("5000"), std::string::npos);
}

/// A call that fails while a device is opened: function, number of the call, result.
class OpeningCudaDeviceTest : public ::testing::TestWithParam<std::string> {};

TEST_P(OpeningCudaDeviceTest, FailsWithoutLeaks) {
  const StubDriver stub;
  StubDriver::configure("fail=" + GetParam());
  EXPECT_NE(error_of([&] { open(stub); }), "no error");
  EXPECT_EQ(StubDriver::objects("contexts"), 0u);
  EXPECT_EQ(StubDriver::objects("leaked"), 0u);
  EXPECT_NO_THROW(open(stub));
}

INSTANTIATE_TEST_SUITE_P(Steps, OpeningCudaDeviceTest,
                         ::testing::Values("cuDeviceGetCount:1:999", "cuDeviceGet:1:101", "cuDeviceGetName:1:1",
                                           "cuDeviceTotalMem_v2:1:1", "cuDeviceGetAttribute:3:1",
                                           "cuDevicePrimaryCtxRetain:1:2", "cuCtxPushCurrent_v2:1:201",
                                           "cuStreamCreate:1:2", "cuModuleLoadDataEx:1:2", "cuModuleGetFunction:2:500",
                                           "cuFuncGetAttribute:1:1", "cuModuleGetGlobal_v2:1:500", "cuMemHostAlloc:1:2",
                                           "cuEventCreate:7:2", "cuMemGetInfo_v2:1:1"),
                         [](const auto& tested) { return tested.param.substr(0, tested.param.find(':')); });

}  // namespace
}  // namespace relume::cuda
