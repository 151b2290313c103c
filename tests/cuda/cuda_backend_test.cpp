// A Backend that sends its launches to the CUDA backend, on the stub driver.
#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <stop_token>
#include <string>

#include "core/array.h"
#include "frame/cuda/cuda_device.h"
#include "frame/launch.h"
#include "kernels.h"
#include "relume/error.h"
#include "stub_driver.h"

namespace relume::cuda {
namespace {

using testing::AddKernel;
using testing::PositionKernel;
using testing::RowSumKernel;
using testing::StubDriver;

class CudaBackendTest : public ::testing::Test {
 protected:
  StubDriver stub_;
  std::unique_ptr<Device> device_ = open_device(stub_.driver(), testing::test_device_code());
};

TEST_F(CudaBackendTest, RunsKernelsAndHostCodeInOrder) {
  Backend backend(*device_, 1);
  Array<uint32_t> values(backend.memory());
  Array<uint32_t> sums(backend.memory());
  values.assign(4 * 128, 1);
  sums.assign(4, 0);
  EXPECT_TRUE(launch(backend, "add", AddKernel{2, values.mutable_view()}, 4 * 128, 1));
  backend.run("host", [&] { values.write()[0] += 10; });
  EXPECT_TRUE(launch(backend, "sum", RowSumKernel{values.view(), sums.mutable_view()}, Tile{0, 0, 1, 4}));
  EXPECT_EQ(sums.read()[0], 3u * 128 + 10);
  EXPECT_EQ(sums.read()[3], 3u * 128);
}

TEST_F(CudaBackendTest, DividesLaunchesThatCanBeStopped) {
  constexpr uint32_t kWidth = 40;
  constexpr uint32_t kHeight = 300;
  Backend backend(*device_, 1);
  Array<uint32_t> image(backend.memory());
  image.assign(size_t{kWidth} * kHeight, 0);
  const PositionKernel kernel{image.mutable_view(), kWidth};
  std::stop_source source;
  for (int i = 0; i < 3; ++i) EXPECT_TRUE(launch(backend, "draw", kernel, kWidth, kHeight, source.get_token()));
  EXPECT_EQ(image.read()[kWidth * kHeight - 1], (kHeight - 1) * 1000 + kWidth - 1);
  backend.run("host", [] {});
  ASSERT_FALSE(backend.times().empty());
  EXPECT_EQ(backend.times().front().name, "draw");
  EXPECT_GT(backend.times().front().seconds, 0);
  source.request_stop();
  EXPECT_FALSE(launch(backend, "draw", kernel, kWidth, kHeight, source.get_token()));
}

TEST_F(CudaBackendTest, LaunchesShortKernelsAsGraphs) {
  constexpr uint32_t kElements = 500;
  Backend backend(*device_, 1);
  Array<uint32_t> values(backend.memory());
  values.assign(kElements, 0);
  std::stop_source source;
  size_t launches = 0;
  for (int frame = 0; frame < 6; ++frame) {
    for (int pass = 1; pass <= 6; ++pass) {
      const AddKernel kernel{static_cast<uint8_t>(pass), values.mutable_view()};
      EXPECT_TRUE(launch(backend, "pass", kernel, kElements, 1, source.get_token()));
    }
    backend.run("host", [] {});
    if (frame == 2) launches = StubDriver::calls("cuLaunchKernel");
  }
  EXPECT_EQ(StubDriver::calls("cuLaunchKernel"), launches);
  EXPECT_GE(StubDriver::calls("cuGraphLaunch"), 4u);
  for (const uint32_t value : values.read()) EXPECT_EQ(value, 6u * (1 + 2 + 3 + 4 + 5 + 6));
}

TEST_F(CudaBackendTest, StopsWithLaunchesThatWait) {
  constexpr uint32_t kElements = 500;
  Backend backend(*device_, 1);
  Array<uint32_t> values(backend.memory());
  values.assign(kElements, 0);
  std::stop_source source;
  const AddKernel kernel{1, values.mutable_view()};
  for (int i = 0; i < 5; ++i) {
    EXPECT_TRUE(launch(backend, "add", kernel, kElements, 1, source.get_token()));
    backend.run("host", [] {});
  }
  const size_t before = StubDriver::calls("cuLaunchKernel");
  EXPECT_TRUE(launch(backend, "add", kernel, kElements, 1, source.get_token()));
  EXPECT_TRUE(launch(backend, "add", kernel, kElements, 1, source.get_token()));
  EXPECT_EQ(StubDriver::calls("cuLaunchKernel"), before) << "they wait for the next ones";
  source.request_stop();
  EXPECT_FALSE(launch(backend, "add", kernel, kElements, 1, source.get_token()));
  EXPECT_EQ(values.read()[0], 7u) << "the launches before the stop are executed";
}

TEST_F(CudaBackendTest, StopsBetweenBandsAndDrains) {
  constexpr uint32_t kElements = 100000;
  Backend backend(*device_, 1);
  Array<uint32_t> values(backend.memory());
  values.assign(kElements, 0);
  std::stop_source source;
  int bands = 0;
  backend.on_tile([&] {
    if (++bands == 3) source.request_stop();
  });
  const AddKernel kernel{1, values.mutable_view()};
  EXPECT_FALSE(launch(backend, "add", kernel, kElements, 1, source.get_token()));
  const size_t launched = StubDriver::calls("cuLaunchKernel");
  EXPECT_EQ(launched, 2u);
  backend.on_tile({});
  EXPECT_EQ(values.read()[0], 1u) << "the bands before the stop are executed";
  EXPECT_EQ(values.read()[kElements - 1], 0u);
  EXPECT_TRUE(launch(backend, "add", kernel, kElements, 1));
  EXPECT_EQ(values.read()[0], 2u);
  EXPECT_EQ(values.read()[kElements - 1], 1u);
}

TEST_F(CudaBackendTest, FinishesNestedLaunches) {
  Backend backend(*device_, 1);
  Array<uint32_t> values(backend.memory());
  values.assign(500, 0);
  std::stop_source source;
  backend.run("outer", [&] {
    EXPECT_TRUE(launch(backend, "inner", AddKernel{1, values.mutable_view()}, 500, 1, source.get_token()));
    EXPECT_EQ(values.view()[499], 1u) << "host code may read the results";
  });
}

TEST_F(CudaBackendTest, DrainsAfterAHookThatThrows) {
  Backend backend(*device_, 1);
  Array<uint32_t> values(backend.memory());
  values.assign(5000, 0);
  int bands = 0;
  backend.on_tile([&] {
    if (++bands == 2) throw std::runtime_error("hook");
  });
  std::stop_source source;
  const AddKernel kernel{1, values.mutable_view()};
  EXPECT_THROW(launch(backend, "add", kernel, 5000, 1, source.get_token()), std::runtime_error);
  backend.on_tile({});
  EXPECT_TRUE(launch(backend, "next", kernel, 5000, 1));
  EXPECT_EQ(values.read()[0], 2u);
  EXPECT_EQ(values.read()[4999], 1u);
}

TEST_F(CudaBackendTest, GivesTimesToTheirLaunchesAfterAnError) {
  Backend backend(*device_, 1);
  Array<uint32_t> values(backend.memory());
  values.assign(1000, 0);
  const AddKernel kernel{1, values.mutable_view()};
  StubDriver::configure("fail=cuLaunchKernel:2:701");
  EXPECT_TRUE(launch(backend, "first", kernel, 1000, 1));
  EXPECT_THROW(launch(backend, "second", kernel, 1000, 1), Error);
  EXPECT_TRUE(launch(backend, "third", kernel, 128, 1));
  backend.run("host", [] {});
  for (const LaunchTime& time : backend.times()) {
    if (time.name != "third") continue;
    EXPECT_NEAR(time.seconds, 128e-6, 1e-8);
  }
  EXPECT_EQ(values.read()[0], 2u);
}

TEST_F(CudaBackendTest, ReportsADeviceThatFailsInABand) {
  for (int band = 1; band <= 4; ++band) {
    device_.reset();
    StubDriver::configure("lose=" + std::to_string(band));
    device_ = open_device(stub_.driver(), testing::test_device_code());
    Backend backend(*device_, 1);
    Array<uint32_t> values(backend.memory());
    values.assign(100000, 0);
    std::stop_source source;
    try {
      launch(backend, "add", AddKernel{1, values.mutable_view()}, 100000, 1, source.get_token());
      backend.run("host", [] {});
      ADD_FAILURE() << band;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::device);
      EXPECT_NE(std::string(error.what()).find("failed in or after the launch of 'add'"), std::string::npos)
          << error.what();
    }
    EXPECT_THROW(values.read(), Error);
  }
}

TEST_F(CudaBackendTest, ReportsADeviceThatFails) {
  StubDriver::configure("lose=2");
  Backend backend(*device_, 1);
  Array<uint32_t> values(backend.memory());
  values.assign(16, 0);
  const AddKernel kernel{1, values.mutable_view()};
  EXPECT_THROW(
      {
        for (int i = 0; i < 3; ++i) launch(backend, "add", kernel, 16, 1);
        backend.run("host", [] {});
      },
      Error);
  EXPECT_THROW(backend.run("host", [] {}), Error);
  EXPECT_THROW(launch(backend, "add", kernel, 16, 1), Error);
}

}  // namespace
}  // namespace relume::cuda
