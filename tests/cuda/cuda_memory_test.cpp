// Memory of the CUDA backend on the stub driver: limits, moves between host and device, waiting.
#include <gtest/gtest.h>

#include <cstdint>
#include <memory>
#include <new>
#include <string>
#include <type_traits>

#include "core/array.h"
#include "frame/cuda/cuda_device.h"
#include "framebuffer/block_pool.h"
#include "kernels.h"
#include "launch_kernel.h"
#include "relume/error.h"
#include "stub_driver.h"

namespace relume::cuda {
namespace {

using testing::AddKernel;
using testing::queue;
using testing::StubDriver;

constexpr size_t kMiB = size_t{1} << 20;
constexpr uint32_t kLarge = 100000;  ///< elements of a block that is moved as a whole

std::unique_ptr<Device> open(const StubDriver& stub, size_t memory_bytes = 0) {
  return open_device(stub.driver(), testing::test_device_code(), {0, memory_bytes});
}

static_assert(std::is_nothrow_copy_constructible_v<DeviceMemoryError>, "a copy must not throw during a throw");

/// The sentence of the DeviceMemoryError of an allocation.
std::string refusal(Memory& memory, size_t bytes, size_t alignment = 16) {
  try {
    memory.deallocate(memory.allocate(bytes, alignment), bytes, alignment);
  } catch (const DeviceMemoryError& error) {
    return error.what();
  }
  return "no error";
}

size_t moves() { return StubDriver::calls("cuMemPrefetchAsync"); }

TEST(CudaMemory, IsLimited) {
  const StubDriver stub;
  const std::unique_ptr<Device> device = open(stub, 10 * kMiB);
  Memory& memory = device->memory();
  void* const block = memory.allocate(6 * kMiB, 16);
  EXPECT_EQ(
      refusal(memory, 5 * kMiB),
      "Stub GPU 0 (cuda:0) has no room for 5.0 MiB: 6.0 MiB of 10.0 MiB are in use; use a smaller image or scene, "
      "or end other programs that use the GPU");
  EXPECT_EQ(refusal(memory, 4 * kMiB), "no error");
  memory.deallocate(block, 6 * kMiB, 16);
  EXPECT_EQ(refusal(memory, 10 * kMiB), "no error");
}

TEST(CudaMemory, IsInTheStatistics) {
  const StubDriver stub("version=12040 memory=1024 devices=2");
  const std::unique_ptr<Device> device = open_device(stub.driver(), testing::test_device_code(), {1, 0});
  const DeviceStatistics before = device->statistics().value();
  EXPECT_EQ(before.name, "Stub GPU 1 (cuda:1)");
  EXPECT_EQ(before.driver, "12.4");
  EXPECT_EQ(before.memory_bytes, 1024 * kMiB);
  EXPECT_LT(before.memory_limit_bytes, before.memory_bytes);
  void* const block = device->memory().allocate(6 * kMiB, 16);
  EXPECT_EQ(device->statistics()->memory_used_bytes, before.memory_used_bytes + 6 * kMiB);
  device->memory().deallocate(block, 6 * kMiB, 16);
  device->finish();
  EXPECT_EQ(device->statistics()->memory_used_bytes, before.memory_used_bytes);
}

TEST(CudaMemory, IsSharedByTheDevicesOfAGpu) {
  const StubDriver stub("memory=356 devices=2");  // 256 MiB are spare
  const std::unique_ptr<Device> first = open(stub);
  const std::unique_ptr<Device> second = open(stub);
  const std::unique_ptr<Device> other = open_device(stub.driver(), testing::test_device_code(), {.index = 1});
  void* const block = first->memory().allocate(60 * kMiB, 16);
  EXPECT_NE(refusal(second->memory(), 50 * kMiB).find("no room for 50.0 MiB: 60.0 MiB of 100.0 MiB"),
            std::string::npos);
  EXPECT_EQ(refusal(second->memory(), 40 * kMiB), "no error");
  EXPECT_EQ(refusal(other->memory(), 100 * kMiB), "no error") << "another GPU";
  first->memory().deallocate(block, 60 * kMiB, 16);
  EXPECT_EQ(refusal(second->memory(), 100 * kMiB), "no error");
}

TEST(CudaMemory, IsNotSharedWithoutConcurrentAccess) {
  const StubDriver stub("concurrent=0 devices=2");
  std::unique_ptr<Device> first = open(stub);
  try {
    open(stub);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::device);
    EXPECT_EQ(std::string(error.what()),
              "Stub GPU 0 (cuda:0) is in use by another session, and cannot be shared, because it has no concurrent "
              "access to managed memory; end that session first, or use --device cpu");
  }
  EXPECT_NO_THROW(open_device(stub.driver(), testing::test_device_code(), {.index = 1}));
  first.reset();
  EXPECT_NO_THROW(open(stub));
}

TEST(CudaMemory, FreesBlocksWhenTheirWorkHasEnded) {
  const StubDriver stub;
  const std::unique_ptr<Device> device = open(stub, 10 * kMiB);
  Array<uint32_t> used(device->memory());
  used.assign(6 * kMiB / sizeof(uint32_t), 0);
  queue(*device, AddKernel{1, used.mutable_view()}, {0, 0, 100, 1});
  const size_t waits = StubDriver::calls("cuEventSynchronize");
  used = Array<uint32_t>(device->memory());
  EXPECT_EQ(StubDriver::calls("cuEventSynchronize"), waits) << "it does not wait";
  EXPECT_EQ(StubDriver::objects("managed"), 1u) << "the kernel still writes to it";
  EXPECT_EQ(refusal(device->memory(), 3 * kMiB), "no error");
  EXPECT_EQ(StubDriver::calls("cuEventSynchronize"), waits);
  EXPECT_EQ(refusal(device->memory(), 5 * kMiB), "no error") << "it waits where it needs the room";
  EXPECT_EQ(StubDriver::objects("managed"), 0u);
}

TEST(CudaMemory, LeavesRoomForTheDriverAndStacks) {
  const StubDriver stub("memory=300 stack=131072");  // of 256 threads: 32 MiB
  const std::unique_ptr<Device> device = open(stub);
  EXPECT_EQ(refusal(device->memory(), (300 - 256 - 32) * kMiB), "no error");
  EXPECT_NE(refusal(device->memory(), (300 - 256 - 32) * kMiB + 1), "no error");
}

TEST(CudaMemory, SaysThatTheDriverHasNoMore) {
  const StubDriver stub("fail=cuMemAllocManaged:1:2");
  const std::unique_ptr<Device> device = open(stub);
  EXPECT_EQ(refusal(device->memory(), 3 * kMiB),
            "Stub GPU 0 (cuda:0): allocating 3.0 MiB failed: CUDA_ERROR_OUT_OF_MEMORY (out of memory); use a smaller "
            "image or scene, or end other programs that use the GPU");
  EXPECT_EQ(refusal(device->memory(), 3 * kMiB), "no error");
}

TEST(CudaMemory, KeepsItsTotalAfterFailures) {
  const StubDriver stub("fail=cuMemAllocManaged:2:2");
  const std::unique_ptr<Device> device = open(stub, 10 * kMiB);
  EXPECT_EQ(refusal(device->memory(), 8 * kMiB), "no error");
  EXPECT_NE(refusal(device->memory(), 8 * kMiB), "no error");
  EXPECT_EQ(refusal(device->memory(), 8 * kMiB), "no error");
  EXPECT_NE(refusal(device->memory(), 1, size_t{1} << 30), "no error") << "an alignment that blocks do not have";
  EXPECT_EQ(refusal(device->memory(), 10 * kMiB), "no error");
  EXPECT_EQ(StubDriver::objects("managed"), 0u);
}

TEST(CudaMemory, HasEmptyBlocks) {
  const StubDriver stub;
  const std::unique_ptr<Device> device = open(stub);
  EXPECT_EQ(refusal(device->memory(), 0), "no error");
}

TEST(CudaMemory, LetsPoolsFreeTheirSpareBlocks) {
  const StubDriver stub;
  const std::unique_ptr<Device> device = open(stub, 10 * kMiB);
  const std::shared_ptr<BlockPool> pool = BlockPool::create(device->memory());
  pool->raise_limit(8 * kMiB);
  pool->take(6 * kMiB).reset();
  EXPECT_NO_THROW(pool->take(7 * kMiB));
}

TEST(CudaMemory, MovesBlocksThatTheHostOpens) {
  const StubDriver stub;
  const std::unique_ptr<Device> device = open(stub);
  Array<uint32_t> large(device->memory());
  Array<uint32_t> small(device->memory());
  large.assign(kLarge, 0);
  small.assign(8, 0);
  EXPECT_EQ(moves(), 0u) << "new blocks are where the host writes them";
  queue(*device, AddKernel{1, large.mutable_view()}, {0, 0, kLarge, 1});
  EXPECT_EQ(moves(), 1u) << "the large one to the device";
  queue(*device, AddKernel{1, large.mutable_view()}, {0, 0, kLarge, 1});
  EXPECT_EQ(moves(), 1u) << "it was on the device";
  EXPECT_EQ(large.read()[0], 2u);
  EXPECT_EQ(moves(), 2u) << "to the host";
  EXPECT_EQ(large.read()[kLarge - 1], 2u);
  EXPECT_EQ(small.read()[0], 0u);
  EXPECT_EQ(moves(), 2u) << "small blocks move when they are accessed";
  queue(*device, AddKernel{1, large.mutable_view()}, {0, 0, kLarge, 1});
  EXPECT_EQ(moves(), 3u);
}

TEST(CudaMemory, MovesToItsOwnDevice) {
  const StubDriver stub("devices=2");
  const std::unique_ptr<Device> device = open_device(stub.driver(), testing::test_device_code(), {.index = 1});
  Array<uint32_t> values(device->memory());
  values.assign(kLarge, 0);
  queue(*device, AddKernel{1, values.mutable_view()}, {0, 0, kLarge, 1});
  EXPECT_EQ(StubDriver::objects("moved to 1"), 1u);
  EXPECT_EQ(StubDriver::objects("moved to 0"), 0u);
  EXPECT_EQ(values.read()[7], 1u);
}

TEST(CudaMemory, IsNotMovedWithoutConcurrentAccess) {
  const StubDriver stub("concurrent=0");
  const std::unique_ptr<Device> device = open(stub);
  Array<uint32_t> values(device->memory());
  values.assign(kLarge, 0);
  queue(*device, AddKernel{1, values.mutable_view()}, {0, 0, kLarge, 1});
  EXPECT_EQ(values.read()[0], 1u);
  EXPECT_EQ(moves(), 0u);
}

TEST(CudaMemory, IsCopiedAndClearedInTheOrderOfLaunches) {
  for (const char* settings : {"", "eager=1", "concurrent=0"}) {
    const StubDriver stub(settings);
    const std::unique_ptr<Device> device = open(stub);
    Array<uint32_t> from(device->memory());
    Array<uint32_t> to(device->memory());
    from.assign(16, 3);
    to.assign(16, 7);
    queue(*device, AddKernel{1, from.mutable_view()}, {0, 0, 16, 1});
    device->memory().copy(to.mutable_view().data + 4, from.view().data, 8 * sizeof(uint32_t));
    queue(*device, AddKernel{1, to.mutable_view()}, {0, 0, 16, 1});
    device->memory().zero(from.mutable_view().data + 1, 2 * sizeof(uint32_t));
    device->memory().zero(from.mutable_view().data, 0);
    EXPECT_EQ(to.read()[3], 8u) << settings;
    EXPECT_EQ(to.read()[4], 5u) << settings;
    EXPECT_EQ(to.read()[12], 8u) << settings;
    EXPECT_EQ(from.read()[0], 4u) << settings;
    EXPECT_EQ(from.read()[2], 0u) << settings;
    EXPECT_EQ(from.read()[3], 4u) << settings;
    device->finish();
    EXPECT_EQ(device->take_times().size(), 2u) << settings;
  }
}

TEST(CudaMemory, SaysWhichCopyFails) {
  const StubDriver stub("fail=cuMemcpyDtoDAsync_v2:1:1 fail=cuMemsetD8Async:1:1");
  const std::unique_ptr<Device> device = open(stub);
  Array<uint32_t> values(device->memory());
  values.assign(size_t{1} << 18, 3);
  uint32_t* const data = values.mutable_view().data;
  const auto problem = [](const auto& action) -> std::string {
    try {
      action();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  EXPECT_NE(problem([&] { device->memory().copy(data, data + 100, 4); }).find("copying 0.0 MiB failed"),
            std::string::npos);
  EXPECT_NE(problem([&] { device->memory().zero(data, kMiB); }).find("clearing 1.0 MiB failed"), std::string::npos);
  EXPECT_EQ(values.read()[100], 3u);
}

TEST(CudaMemory, IsNotFreedBeforeItsMove) {
  const StubDriver stub("fail=cuMemcpyDtoDAsync_v2:1:1");
  const std::unique_ptr<Device> device = open(stub);
  Array<uint32_t> values(device->memory());
  values.assign(16, 0);
  {
    Array<uint32_t> from(device->memory());
    Array<uint32_t> to(device->memory());
    from.assign(kLarge, 1);
    to.assign(kLarge, 0);
    EXPECT_THROW(device->memory().copy(to.mutable_view().data, from.view().data, kLarge * sizeof(uint32_t)), Error);
  }
  queue(*device, AddKernel{1, values.mutable_view()}, {0, 0, 16, 1});
  EXPECT_NO_THROW(device->finish());
  EXPECT_EQ(values.read()[0], 1u);
}

TEST(CudaMemory, PermitsReadingWithoutAMove) {
  const StubDriver stub;
  const std::unique_ptr<Device> device = open(stub);
  Array<uint32_t> values(device->memory());
  values.assign(kLarge, 0);
  queue(*device, AddKernel{1, values.mutable_view()}, {0, 0, kLarge, 1});
  const size_t before = moves();
  values.permit_reading();
  EXPECT_EQ(values.view()[5], 1u) << "it waits for the launch";
  EXPECT_EQ(moves(), before);
  values.write()[5] = 9;
  EXPECT_EQ(moves(), before + 1);
  queue(*device, AddKernel{1, values.mutable_view()}, {0, 0, kLarge, 1});
  EXPECT_EQ(values.read()[5], 10u);
}

TEST(CudaMemory, IsOpenedAgainWithoutTheDriver) {
  const StubDriver stub;
  const std::unique_ptr<Device> device = open(stub);
  Array<uint32_t> values(device->memory());
  values.assign(16, 0);
  queue(*device, AddKernel{1, values.mutable_view()}, {0, 0, 16, 1});
  values.write()[0] = 5;
  const size_t before = StubDriver::calls("cuCtxPushCurrent_v2");
  for (int i = 0; i < 10; ++i) values.write()[0] += values.read()[1];
  EXPECT_EQ(StubDriver::calls("cuCtxPushCurrent_v2"), before);
  EXPECT_EQ(values.read()[0], 15u);
}

TEST(CudaMemory, WaitsBeforeItIsOpenedOrFreed) {
  const StubDriver stub;
  const std::unique_ptr<Device> device = open(stub);
  Array<uint32_t> values(device->memory());
  values.assign(16, 0);
  for (int i = 0; i < 10; ++i) queue(*device, AddKernel{1, values.mutable_view()}, {0, 0, 16, 1});
  values.write()[3] += 5;
  EXPECT_EQ(values.read()[3], 15u);
  Array<uint32_t> other(device->memory());
  other.assign(16, 0);
  queue(*device, AddKernel{1, other.mutable_view()}, {0, 0, 16, 1});
  other = Array<uint32_t>(device->memory());  // the kernel still writes to it
  EXPECT_NO_THROW(device->finish());
}

/// The stub closes managed memory while launches are queued: this is how the tests above notice missing waits.
TEST(CudaMemoryDeathTest, IsClosedWhileLaunchesAreQueued) {
  const StubDriver stub;
  const std::unique_ptr<Device> device = open(stub);
  Array<uint32_t> values(device->memory());
  values.assign(16, 0);
  const std::span<const uint32_t> before = values.read();
  queue(*device, AddKernel{1, values.mutable_view()}, {0, 0, 16, 1});
  EXPECT_DEATH(EXPECT_EQ(before[0], 1u), "");
}

}  // namespace
}  // namespace relume::cuda
