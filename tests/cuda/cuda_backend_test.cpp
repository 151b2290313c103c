// A Backend that sends its launches to the CUDA backend, on the stub driver.
#include <gtest/gtest.h>

#include <memory>
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
