// The list of GPUs, and why relume cannot use some.
#include "frame/cuda/devices.h"

#include <gtest/gtest.h>

#include <string>

#include "relume/error.h"
#include "stub_driver.h"

namespace relume::cuda {
namespace {

using testing::StubDriver;

std::string problem_with(const std::string& settings) {
  const StubDriver stub(settings);
  return gpu_info(stub.driver(), 0).problem;
}

TEST(CudaDevices, AreDescribed) {
  const StubDriver stub("devices=2 capability=86 memory=8192 concurrent=0");
  const GpuInfo gpu = gpu_info(stub.driver(), 1);
  EXPECT_EQ(gpu.index, 1);
  EXPECT_EQ(gpu.name, "Stub GPU 1");
  EXPECT_EQ(gpu.memory_bytes, size_t{8} << 30);
  EXPECT_EQ(gpu.capability_major, 8);
  EXPECT_EQ(gpu.capability_minor, 6);
  EXPECT_EQ(gpu.multiprocessors, 2);
  EXPECT_EQ(gpu.threads_per_multiprocessor, 128);
  EXPECT_FALSE(gpu.concurrent_access);
  EXPECT_EQ(gpu.problem, "");
}

TEST(CudaDevices, AreRefusedForAReason) {
  EXPECT_EQ(problem_with("capability=70"),
            "its compute capability is 7.0, but relume needs 7.5; use another GPU or --device cpu");
  EXPECT_EQ(problem_with("capability=75"), "");
  EXPECT_EQ(problem_with("managed=0"), "it has no managed memory; use another GPU or --device cpu");
  EXPECT_EQ(problem_with("prohibited=1"),
            "its compute mode is 'prohibited'; change it with nvidia-smi --compute-mode=0");
}

TEST(CudaDevices, ThatDoNotExistAreErrors) {
  const StubDriver stub("devices=2");
  for (const int index : {-1, 2}) {
    try {
      gpu_info(stub.driver(), index);
      ADD_FAILURE() << index;
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()), "there is no GPU " + std::to_string(index) +
                                               ": the driver has 2 (relume devices lists them); use --device cuda:N "
                                               "with a smaller N, or --device cpu");
    }
  }
}

TEST(CudaDevices, AreListed) {
  const StubDriver stub("devices=2 version=12040");
  const GpuList list = list_gpus();
  EXPECT_EQ(list.driver_version, "12.4");
  EXPECT_EQ(list.problem, "");
  ASSERT_EQ(list.gpus.size(), 2u);
  EXPECT_EQ(list.gpus[1].name, "Stub GPU 1");
  StubDriver::configure("devices=0");
  EXPECT_EQ(list_gpus().problem, "the CUDA driver has found no GPU; check that nvidia-smi lists one");
}

}  // namespace
}  // namespace relume::cuda
