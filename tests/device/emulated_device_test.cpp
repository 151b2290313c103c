#include "device/emulated_device.h"

#include <gtest/gtest.h>

#include <numeric>

#include "device/kernels.h"
#include "frame/launch.h"
#include "frame/primitives/fill.h"
#include "relume/error.h"

namespace relume::testing {
namespace {

/// On the host only.
struct UnlistedKernel {
  RELUME_HD void operator()(uint32_t, uint32_t) const {}
};

class EmulatedDeviceTest : public ::testing::Test {
 protected:
  void SetUp() override { walls_.end_launch(); }
  void TearDown() override {
    for (const std::string& violation : walls_.violations()) ADD_FAILURE() << violation;
  }
  /// Sets `count` elements from `first` on to `value`.
  void fill(uint32_t first, uint32_t count, uint32_t value) {
    relume::fill(backend_, "fill", View<uint32_t>{values_.mutable_view().data + first, count}, value);
  }
  uint64_t sum_of_values() const {
    const std::span<const uint32_t> values = values_.read();
    return std::accumulate(values.begin(), values.end(), uint64_t{0});
  }

  WalledMemory walls_;
  EmulatedDevice device_{walls_, {&ptx::all_kernels}};
  Backend backend_{device_, 2};
  Array<uint32_t> values_{device_.memory()};
};

TEST_F(EmulatedDeviceTest, RunsLaunchesWhenTheHostReads) {
  values_.assign(1000, 1);
  fill(0, 1000, 2);
  fill(10, 100, 5);
  EXPECT_EQ(device_.launches(), 2u);
  EXPECT_TRUE(device_.take_times().empty()) << "they are queued";
  EXPECT_EQ(sum_of_values(), 900u * 2 + 100u * 5);
  EXPECT_EQ(device_.take_times().size(), 2u);
}

TEST_F(EmulatedDeviceTest, FinishesLaunchesBeforeMemoryIsFreed) {
  Array<uint32_t> copy(device_.memory());
  copy.reset(1000, kUninitialized);
  {
    Array<uint32_t> source(device_.memory());
    source.assign(1000, 7);
    relume::copy(backend_, "copy", source.view(), copy.mutable_view());
  }
  EXPECT_EQ(copy.read()[999], 7u);
}

TEST_F(EmulatedDeviceTest, StopsBetweenBands) {
  constexpr uint32_t kCount = 100'000;
  constexpr uint32_t kFirstBand = 32;
  values_.assign(kCount, 1);
  std::stop_source stop;
  size_t bands = 0;
  backend_.on_tile([&] {
    if (++bands == 2) stop.request_stop();
  });
  const FillElementsKernel<uint32_t> kernel{values_.mutable_view(), 3};
  EXPECT_FALSE(launch(backend_, "fill", kernel, kCount, 1, stop.get_token()));
  EXPECT_EQ(sum_of_values(), kCount + 2 * kFirstBand);
  backend_.on_tile({});
  EXPECT_TRUE(launch(backend_, "fill", kernel, kCount, 1, std::stop_source().get_token()));
  EXPECT_EQ(sum_of_values(), 3u * kCount);
}

TEST_F(EmulatedDeviceTest, ReportsKernelsWithoutAnEntry) {
  try {
    launch(backend_, "unlisted", UnlistedKernel{}, 1, 1);
    FAIL() << "the launch succeeded";
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()),
              "launch 'unlisted': the device code has no entry for the kernel relume::testing::(anonymous "
              "namespace)::UnlistedKernel; add the kernel to the kernels.inc of its folder");
  }
}

TEST_F(EmulatedDeviceTest, ReportsFaultsWhenTheHostWaits) {
  values_.assign(16, 1);
  auto* const misaligned = reinterpret_cast<uint32_t*>(reinterpret_cast<char*>(values_.mutable_view().data) + 1);
  relume::fill(backend_, "misaligned", View<uint32_t>{misaligned, 4}, 9u);
  fill(0, 16, 5);
  try {
    backend_.execute([] {});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what())
                  .find("launch 'misaligned': the kernel relume::FillElementsKernel<unsigned int> "
                        "failed on the device: address "),
              std::string::npos)
        << error.what();
  }
  EXPECT_EQ(sum_of_values(), 16u) << "the queue is empty";
  fill(0, 16, 6);
  EXPECT_EQ(sum_of_values(), 96u);
}

}  // namespace
}  // namespace relume::testing
