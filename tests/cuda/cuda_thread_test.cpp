// Memory of the CUDA backend that several threads use while launches are queued, on the stub driver.
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "core/array.h"
#include "frame/cuda/cuda_device.h"
#include "kernels.h"
#include "launch_kernel.h"
#include "stub_driver.h"

namespace relume::cuda {
namespace {

using testing::AddKernel;
using testing::queue;
using testing::StubDriver;

/// With memory that stays open: one thread may access a block while a launch uses another.
class CudaThreadTest : public ::testing::TestWithParam<const char*> {
 protected:
  StubDriver stub_{GetParam()};
  std::unique_ptr<Device> device_ = open_device(stub_.driver(), testing::test_device_code());
};

TEST_P(CudaThreadTest, MemoryIsUsedDuringLaunches) {
  constexpr int kThreads = 4;
  constexpr int kRounds = 100;
  Memory& memory = device_->memory();
  Array<uint32_t> launched(memory);
  launched.assign(16, 0);
  std::atomic<int> errors = 0;
  std::vector<std::thread> threads;
  for (int t = 0; t < kThreads; ++t) {
    threads.emplace_back([&, t] {
      for (int i = 0; i < kRounds; ++i) {
        const auto number = static_cast<uint32_t>(1000 * t + i);
        Array<uint32_t> from(memory);
        Array<uint32_t> to(memory);
        from.assign(i % 10 == 0 ? 20000 : 100, number);  // some are moved as a whole
        to.reset(from.size(), kUninitialized);
        memory.copy(to.mutable_view().data, from.view().data, from.size() * sizeof(uint32_t));
        memory.zero(to.mutable_view().data, sizeof(uint32_t));
        if (to.read()[0] != 0 || to.read()[from.size() - 1] != number) ++errors;
      }
    });
  }
  for (uint32_t i = 0; i < kRounds; ++i) {
    queue(*device_, AddKernel{1, launched.mutable_view()}, {0, 0, 16, 1}, "test", i % 3 > 0);  // some may wait
    if (i % 7 == 0) device_->finish();
    device_->take_times();
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(errors, 0);
  EXPECT_EQ(launched.read()[3], static_cast<uint32_t>(kRounds));
  device_->finish();
  EXPECT_EQ(StubDriver::objects("managed"), 1u);
}

INSTANTIATE_TEST_SUITE_P(Drivers, CudaThreadTest, ::testing::Values("open=1", "open=1 eager=1"),
                         [](const auto& tested) { return std::string(tested.index == 0 ? "deferred" : "eager"); });

}  // namespace
}  // namespace relume::cuda
