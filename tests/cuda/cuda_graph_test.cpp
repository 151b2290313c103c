// Graphs of launches on the stub driver: when they are made, changed and launched, and that they change no results.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
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
using testing::queue_waiting;
using testing::RowSumKernel;
using testing::StubDriver;

constexpr uint32_t kElements = 300;

std::unique_ptr<Device> open(const StubDriver& stub, bool graphs = true) {
  return open_device(stub.driver(), testing::test_device_code(), {.graphs = graphs});
}

size_t kernel_launches() { return StubDriver::calls("cuLaunchKernel"); }
size_t graph_launches() { return StubDriver::calls("cuGraphLaunch"); }
size_t graphs_made() { return StubDriver::calls("cuGraphInstantiate_v2"); }
size_t graphs_updated() { return StubDriver::calls("cuGraphExecUpdate"); }

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

/// An array to which launches append digits, and the values that it should have.
class Digits {
 public:
  explicit Digits(Device& device) : device_(device), values_(device.memory()) {
    values_.assign(kElements, 0);
    expected_.assign(kElements, 0);
  }

  /// A launch that may wait, for the first elements.
  void append(uint64_t digit, uint32_t elements = kElements, const std::string& name = "append") {
    queue_waiting(device_, AppendKernel{values_.mutable_view(), digit}, {0, 0, elements, 1}, name);
    note(digit, elements);
  }
  void append_at_once(uint64_t digit) {
    queue(device_, AppendKernel{values_.mutable_view(), digit}, {0, 0, kElements, 1});
    note(digit, kElements);
  }
  /// `count` launches, which the device then executes.
  void append_all(uint64_t first_digit, size_t count, uint32_t elements = kElements) {
    for (size_t i = 0; i < count; ++i) append(first_digit + i, elements);
    device_.finish();
  }
  bool correct() const { return std::ranges::equal(values_.read(), expected_); }
  Array<uint64_t>& values() { return values_; }

 private:
  void note(uint64_t digit, uint32_t elements) {
    for (uint32_t i = 0; i < elements; ++i) expected_[i] = expected_[i] * 31 + digit;
  }

  Device& device_;
  Array<uint64_t> values_;
  std::vector<uint64_t> expected_;
};

/// Runs with work that is executed at once, or when the host waits for it; with and without concurrent access.
class CudaGraphTest : public ::testing::TestWithParam<std::string> {
 protected:
  StubDriver stub_{GetParam()};
  std::unique_ptr<Device> device_ = open(stub_);
  Digits digits_{*device_};
};

TEST_P(CudaGraphTest, IsMadeOfASequenceThatComesAgain) {
  digits_.append_all(1, 4);
  EXPECT_EQ(kernel_launches(), 4u);
  EXPECT_EQ(graph_launches(), 0u);
  digits_.append_all(5, 4);
  EXPECT_EQ(kernel_launches(), 8u) << "they are captured";
  EXPECT_EQ(graph_launches(), 1u);
  for (uint64_t round = 0; round < 3; ++round) digits_.append_all(9 + round, 4);
  EXPECT_EQ(kernel_launches(), 8u) << "other digits are other arguments in the same memory";
  EXPECT_EQ(graph_launches(), 4u);
  EXPECT_EQ(graphs_made(), 1u);
  EXPECT_EQ(graphs_updated(), 0u);
  EXPECT_TRUE(digits_.correct());
}

TEST_P(CudaGraphTest, HasTheResultsOfSingleLaunches) {
  for (const bool graphs : {true, false}) {
    digits_.values() = Array<uint64_t>();
    device_.reset();
    device_ = open(stub_, graphs);
    Digits digits(*device_);
    const size_t before = graph_launches();
    for (uint64_t round = 0; round < 6; ++round) {
      for (uint64_t i = 0; i < 5; ++i) digits.append(7 * round + i % 3, kElements - static_cast<uint32_t>(i));
      digits.append_at_once(round);
    }
    EXPECT_TRUE(digits.correct()) << graphs;
    EXPECT_EQ(graph_launches() - before, graphs ? 5u : 0u);
  }
}

TEST_P(CudaGraphTest, IsUpdatedIfAWindowChanges) {
  for (const uint32_t elements : {200u, 200u, 250u, 250u, 130u}) digits_.append_all(elements, 3, elements);
  EXPECT_EQ(graphs_made(), 1u);
  EXPECT_EQ(graphs_updated(), 2u);
  EXPECT_EQ(graph_launches(), 4u);
  EXPECT_EQ(kernel_launches(), 4 * 3u) << "once without a graph, and in three captures";
  EXPECT_TRUE(digits_.correct());
}

TEST_P(CudaGraphTest, IsMadeAgainIfTheNumberOfLaunchesChanges) {
  for (const size_t count : {3u, 3u, 4u, 4u, 3u, 4u}) digits_.append_all(count, count);
  EXPECT_EQ(graphs_made(), 2u);
  EXPECT_EQ(graph_launches(), 4u);
  EXPECT_EQ(graphs_updated(), 0u);
  EXPECT_TRUE(digits_.correct());
}

TEST_P(CudaGraphTest, IsNotThatOfGroupsWithOtherThreads) {
  Array<uint32_t> values(device_->memory());
  Array<uint32_t> sums(device_->memory());
  values.assign(128, 1);
  sums.assign(1, 0);
  const RowSumKernel kernel{values.view(), sums.mutable_view()};
  const auto argument = std::as_bytes(std::span(&kernel, 1));
  for (const uint32_t threads : {64u, 64u, 32u, 32u, 64u}) {
    device_->take_times();
    for (int i = 0; i < 2; ++i)
      device_->launch({"sum", kernel_type_name<RowSumKernel>(), threads, argument, {0, 0, 1, 1}, true});
    device_->finish();
    const std::vector<double> times = device_->take_times();
    ASSERT_EQ(times.size(), 2u);
    for (const double time : times) EXPECT_NEAR(time, threads * 1e-6, 1e-7) << "the stub takes 1 µs for each thread";
  }
  EXPECT_EQ(graphs_made(), 2u);
  EXPECT_EQ(graph_launches(), 3u);
}

TEST_P(CudaGraphTest, CopiesTheSameArgumentOnce) {
  Array<uint32_t> values(device_->memory());
  values.assign(kElements, 0);
  for (int round = 0; round < 3; ++round) {
    for (uint32_t i = 0; i < kElements; i += 100)
      queue_waiting(*device_, AddKernel{1, values.mutable_view()}, {i, 0, i + 100, 1});
    device_->finish();
  }
  EXPECT_EQ(graph_launches(), 2u);
  EXPECT_EQ(StubDriver::calls("cuMemcpyHtoDAsync_v2"), 2u) << "at once, and in the capture";
  for (const uint32_t value : values.read()) EXPECT_EQ(value, 3u);
}

TEST_P(CudaGraphTest, TimesItsLaunches) {
  for (int round = 0; round < 3; ++round) {
    device_->take_times();
    digits_.append(1, 100);
    digits_.append(2, 300);
    digits_.append(3, 200);
    device_->finish();
  }
  EXPECT_EQ(graph_launches(), 2u);
  const std::vector<double> times = device_->take_times();
  ASSERT_EQ(times.size(), 3u);
  // The stub takes 1 µs for each thread, of 128 in a block.
  EXPECT_NEAR(times[0], 128e-6, 1e-7);
  EXPECT_NEAR(times[1], 3 * 128e-6, 1e-7);
  EXPECT_NEAR(times[2], 2 * 128e-6, 1e-7);
}

TEST_P(CudaGraphTest, BeginsWhenMemoryIsUsed) {
  digits_.append(1);
  digits_.append(2);
  EXPECT_EQ(kernel_launches(), 0u);
  EXPECT_TRUE(digits_.correct()) << "the host reads it";
  EXPECT_EQ(kernel_launches(), 2u);
  digits_.append(3);
  digits_.values().permit_reading();
  EXPECT_EQ(kernel_launches(), 3u);
  digits_.append(4);
  device_->memory().zero(digits_.values().mutable_view().data, sizeof(uint64_t));
  EXPECT_EQ(kernel_launches(), 4u);
  EXPECT_EQ(digits_.values().read()[0], 0u) << "it is cleared after the launch";
  digits_.append(5);
  device_->wait(1);
  EXPECT_EQ(kernel_launches(), 5u);
}

TEST_P(CudaGraphTest, HasALimitedNumberOfLaunches) {
  for (int round = 0; round < 3; ++round) {
    for (uint64_t i = 0; i < 100; ++i) digits_.append(i % 10);
    device_->finish();
  }
  EXPECT_TRUE(digits_.correct());
  EXPECT_LE(StubDriver::objects("locked"), 1u + 2u) << "of the slots, of 32 launches and of the last 4";
  EXPECT_EQ(graph_launches(), 2 + 4 + 4u) << "three times 32 and 4; the second 32 repeat the first";
}

TEST_P(CudaGraphTest, IsFreed) {
  Array<uint32_t> values(device_->memory());
  values.assign(1, 0);
  // More sequences than the device keeps: the bits of a number choose the kernels.
  constexpr uint32_t kSequences = 70;
  for (uint32_t sequence = 0; sequence < kSequences; ++sequence) {
    for (int round = 0; round < 2; ++round) {
      for (uint32_t bit = 0; bit < 7; ++bit) {
        if ((sequence >> bit & 1) != 0)
          digits_.append(bit, 1);
        else
          queue_waiting(*device_, AddKernel{1, values.mutable_view()}, {0, 0, 1, 1});
      }
      device_->finish();
    }
  }
  EXPECT_EQ(graph_launches(), kSequences);
  EXPECT_EQ(StubDriver::objects("graphs"), 64u);
  EXPECT_TRUE(digits_.correct());
  values = Array<uint32_t>();
  digits_.values() = Array<uint64_t>();
  device_->finish();
  device_.reset();
  EXPECT_EQ(StubDriver::objects("contexts"), 0u);
  EXPECT_EQ(StubDriver::objects("leaked"), 0u);
}

INSTANTIATE_TEST_SUITE_P(Drivers, CudaGraphTest,
                         ::testing::Values("", "eager=1", "concurrent=0", "eager=1 concurrent=0", "seed=7"),
                         [](const auto& tested) {
                           std::string name = tested.param.empty() ? "deferred" : tested.param;
                           std::replace(name.begin(), name.end(), ' ', '_');
                           std::erase(name, '=');
                           return name;
                         });

TEST(CudaGraphs, MoveMemoryBeforeTheGraph) {
  const StubDriver stub;
  const std::unique_ptr<Device> device = open(stub);
  Array<uint32_t> large(device->memory());
  large.assign(100000, 0);
  for (int round = 0; round < 3; ++round) {
    large.write()[5] += 10;
    for (int i = 0; i < 2; ++i) queue_waiting(*device, AddKernel{1, large.mutable_view()}, {0, 0, 100, 1});
    device->finish();
    device->take_times();
    EXPECT_NEAR(device->take_move_time(), 4e-5, 1e-9) << "the stub takes 0.1 ns for a byte";
  }
  EXPECT_EQ(graph_launches(), 2u);
  EXPECT_EQ(large.read()[5], 36u);
}

TEST(CudaGraphs, AreNotUsedIfTurnedOff) {
  const StubDriver stub;
  const std::unique_ptr<Device> device = open(stub, false);
  Digits digits(*device);
  for (uint64_t round = 0; round < 3; ++round) digits.append_all(round, 4);
  EXPECT_EQ(kernel_launches(), 12u);
  EXPECT_EQ(StubDriver::calls("cuStreamBeginCapture_v2"), 0u);
  EXPECT_TRUE(digits.correct());
}

TEST(CudaGraphs, AreNotUsedWithOldDrivers) {
  const StubDriver stub;
  Driver old = stub.driver();
  EXPECT_TRUE(old.has_graphs());
  old.cuEventRecordWithFlags = nullptr;
  EXPECT_FALSE(old.has_graphs());
  const std::unique_ptr<Device> device = open_device(old, testing::test_device_code());
  Digits digits(*device);
  for (uint64_t round = 0; round < 3; ++round) digits.append_all(round, 4);
  EXPECT_EQ(kernel_launches(), 12u);
  EXPECT_TRUE(digits.correct());
}

/// A driver that refuses a step of using graphs. Launches then need none.
TEST(CudaGraphs, AreGivenUpIfTheDriverRefusesThem) {
  for (const char* call :
       {"cuStreamCreate:2:2", "cuMemHostAlloc:2:2", "cuStreamBeginCapture_v2:1:900", "cuLaunchKernel:5:900",
        "cuEventRecordWithFlags:2:900", "cuStreamEndCapture:1:901", "cuGraphInstantiate_v2:1:2", "cuGraphLaunch:1:2"}) {
    const StubDriver stub(std::string("fail=") + call);
    std::unique_ptr<Device> device = open(stub);
    Digits digits(*device);
    for (uint64_t round = 0; round < 4; ++round) digits.append_all(round, 3);
    EXPECT_TRUE(digits.correct()) << call;
    EXPECT_LE(StubDriver::calls("cuStreamBeginCapture_v2"), 1u) << call << ": it is not tried again";
    EXPECT_LE(graph_launches(), 1u) << call;
    digits.values() = Array<uint64_t>();
    device.reset();
    EXPECT_EQ(StubDriver::objects("leaked"), 0u) << call;
  }
}

TEST(CudaGraphs, AreMadeAgainIfTheDriverRefusesAnUpdate) {
  const StubDriver stub("fail=cuGraphExecUpdate:1:910");
  const std::unique_ptr<Device> device = open(stub);
  Digits digits(*device);
  for (const uint32_t elements : {200u, 200u, 250u, 250u, 130u}) digits.append_all(elements, 3, elements);
  EXPECT_EQ(graphs_made(), 2u);
  EXPECT_EQ(graphs_updated(), 2u);
  EXPECT_EQ(graph_launches(), 4u);
  EXPECT_EQ(StubDriver::objects("graphs"), 1u);
  EXPECT_TRUE(digits.correct());
}

TEST(CudaGraphs, EndWithADeviceThatIsLost) {
  for (int launch = 7; launch <= 9; ++launch) {  // of the third round
    const StubDriver stub("lose=" + std::to_string(launch));
    const std::unique_ptr<Device> device = open(stub);
    Digits digits(*device);
    for (uint64_t round = 0; round < 2; ++round) digits.append_all(round, 3);
    uint64_t digit = 5;
    for (const char* name : {"first", "second", "third"}) digits.append(digit++, kElements, name);
    EXPECT_EQ(error_of([&] { device->finish(); }),
              "Stub GPU 0 (cuda:0) failed in or after the launch of 'first': CUDA_ERROR_LAUNCH_FAILED (unspecified "
              "launch failure); start relume again, or use --device cpu");
    EXPECT_EQ(graph_launches(), 2u);
    EXPECT_NE(error_of([&] { digits.values().read(); }), "no error");
  }
}

TEST(CudaGraphs, DropLaunchesAfterOneThatFails) {
  const StubDriver stub("fail=cuLaunchKernel:2:701");
  const std::unique_ptr<Device> device = open(stub);
  Array<uint64_t> values(device->memory());
  values.assign(1, 0);
  const auto append = [&](uint64_t digit, const char* name) {
    queue_waiting(*device, AppendKernel{values.mutable_view(), digit}, {0, 0, 1, 1}, name);
  };
  append(1, "first");
  append(2, "second");
  append(3, "third");
  EXPECT_NE(error_of([&] { values.read(); }).find("launching 'second' failed"), std::string::npos);
  EXPECT_EQ(values.read()[0], 1u) << "the device has executed the first one";
  append(4, "next");
  EXPECT_EQ(values.read()[0], 35u);
  device->finish();
  const std::vector<double> times = device->take_times();
  ASSERT_EQ(times.size(), 4u) << "all launches that were accepted";
  EXPECT_GT(times[0], 0);
  EXPECT_EQ(times[1], 0);
  EXPECT_EQ(times[2], 0);
  EXPECT_GT(times[3], 0);
}

}  // namespace
}  // namespace relume::cuda
