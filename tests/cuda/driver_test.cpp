// Loading the driver: what it says where the driver is missing, old or without a GPU.
#include "frame/cuda/driver.h"

#include <gtest/gtest.h>

#include <string>

#include "relume/error.h"
#include "stub_driver.h"

namespace relume::cuda {
namespace {

using testing::StubDriver;

/// The sentence of the Error that a driver with these settings ends with.
std::string problem_with(const std::string& settings) {
  try {
    const StubDriver stub(settings);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::device);
    return error.what();
  }
  return "no error";
}

std::string problem_of_library(const std::string& library) {
  try {
    load_driver(library);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

std::string problem_of_system_driver() {
  try {
    driver();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(CudaDriver, IsLoadedWhole) {
  const StubDriver stub;
  Driver driver = stub.driver();
  size_t functions = 0;
  driver.for_each_function([&](const char* symbol, const auto& function) {
    EXPECT_NE(function, nullptr) << symbol;
    ++functions;
  });
  EXPECT_EQ(functions, sizeof(Driver) / sizeof(void*));
}

TEST(CudaDriver, SaysThatItIsMissing) {
  EXPECT_EQ(problem_of_library("libcuda-missing.so.1"),
            "no CUDA driver: libcuda-missing.so.1: cannot open shared object file: No such file or directory; install "
            "NVIDIA's driver, or use --device cpu");
}

TEST(CudaDriver, SaysThatALibraryIsNone) {
  EXPECT_EQ(problem_of_library("libm.so.6"),
            "the CUDA driver has no function cuDriverGetVersion; install a driver for CUDA 10.0 or later, or use "
            "--device cpu");
}

TEST(CudaDriver, SaysThatItIsTooOld) {
  EXPECT_EQ(problem_with("version=9020"),
            "the CUDA driver supports CUDA 9.2, but relume needs 10.0; install a newer driver, or use --device cpu");
  EXPECT_EQ(problem_with("version=10000"), "no error");
}

TEST(CudaDriver, StartsWithAndWithoutGpus) {
  const StubDriver stub;
  EXPECT_TRUE(start(stub.driver()));
  EXPECT_TRUE(start(stub.driver())) << "it is started again";
  StubDriver::configure("devices=0");
  EXPECT_FALSE(start(stub.driver()));
}

TEST(CudaDriver, IsTriedAgainAfterAnError) {
  StubDriver::configure("version=9020");
  problem_of_system_driver();  // the version is too old, unless an earlier test has loaded the driver
  StubDriver::configure("");
  EXPECT_EQ(problem_of_system_driver(), "no error");
}

TEST(CudaDriver, DescribesUnknownErrors) {
  const StubDriver stub;
  EXPECT_EQ(describe(stub.driver(), static_cast<Result>(54321)), "error 54321");
  EXPECT_EQ(describe(stub.driver(), Result::out_of_memory), "CUDA_ERROR_OUT_OF_MEMORY (out of memory)");
}

TEST(CudaDriver, EveryErrorHasARemedy) {
  for (const Result result :
       {Result::out_of_memory, Result::no_device, Result::stub_library, Result::device_unavailable, Result::invalid_ptx,
        Result::jit_compilation_disabled, Result::system_not_ready, Result::launch_timeout, Result::unknown,
        Result::illegal_address, static_cast<Result>(54321)}) {
    EXPECT_FALSE(remedy(result).empty()) << static_cast<int>(result);
  }
}

TEST(CudaDriver, WritesVersions) {
  EXPECT_EQ(version_text(10000), "10.0");
  EXPECT_EQ(version_text(12040), "12.4");
}

}  // namespace
}  // namespace relume::cuda
