// Loading the driver: what it says where the driver is missing, old or without a GPU.
#include "frame/cuda/driver.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <string_view>

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

/// A restart of relume helps against all errors that the table does not list.
TEST(CudaDriver, EveryErrorHasARemedy) {
  const std::map<Result, std::string_view> remedies = {
      {Result::out_of_memory, "use a smaller image or scene"},
      {Result::launch_out_of_resources, "use a smaller image or scene"},
      {Result::stub_library, "LD_LIBRARY_PATH"},
      {Result::device_unavailable, "end the program that uses the GPU exclusively"},
      {Result::no_device, "nvidia-smi lists a GPU"},
      {Result::no_binary_for_device, "install a newer driver"},
      {Result::invalid_ptx, "install a newer driver"},
      {Result::jit_compiler_not_found, "install a newer driver"},
      {Result::unsupported_ptx_version, "install a newer driver"},
      {Result::jit_compilation_disabled, "CUDA_DISABLE_PTX_JIT"},
      {Result::launch_timeout, "without a display"},
      {Result::system_not_ready, "wait until NVIDIA's services run"},
      {Result::system_driver_mismatch, "restart the machine"},
      {Result::compat_not_supported_on_device, "restart the machine"},
      {Result::unknown, "nvidia_uvm"},
  };
  for (int code = 1; code < 1000; ++code) {
    const auto result = static_cast<Result>(code);
    const auto listed = remedies.find(result);
    const std::string_view part = listed != remedies.end() ? listed->second : "start relume again, or use --device cpu";
    EXPECT_NE(remedy(result).find(part), std::string_view::npos) << code << ": " << remedy(result);
  }
}

TEST(CudaDriver, WritesVersions) {
  EXPECT_EQ(version_text(10000), "10.0");
  EXPECT_EQ(version_text(12040), "12.4");
}

}  // namespace
}  // namespace relume::cuda
