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
}

TEST(CudaDevices, AreListedWithoutOne) {
  const StubDriver stub("devices=0 version=12040");
  const GpuList list = list_gpus();
  EXPECT_EQ(list.driver_version, "12.4");
  EXPECT_TRUE(list.gpus.empty());
  const std::string problem =
      "the CUDA driver finds no GPU; check that nvidia-smi lists one and that CUDA_VISIBLE_DEVICES does not hide it, "
      "or "
      "use --device cpu";
  EXPECT_EQ(list.problem, problem);
  try {
    gpu_info(stub.driver(), 0);
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.what(), problem);
  }
}

TEST(CudaDevices, AreListedWithThoseThatSayNothing) {
  const StubDriver stub("devices=3 fail=cuDeviceGetName:2:999");
  const GpuList list = list_gpus();
  EXPECT_EQ(list.problem, "");
  ASSERT_EQ(list.gpus.size(), 3u);
  EXPECT_EQ(list.gpus[0].problem, "");
  EXPECT_EQ(list.gpus[1].index, 1);
  EXPECT_NE(list.gpus[1].problem.find("asking GPU 1 for its name failed"), std::string::npos) << list.gpus[1].problem;
  EXPECT_EQ(list.gpus[2].problem, "");
}

}  // namespace
}  // namespace relume::cuda
