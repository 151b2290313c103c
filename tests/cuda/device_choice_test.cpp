// The setting --device, on the stub driver.
#include "frame/cuda/device_choice.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "relume/error.h"
#include "stub_driver.h"

namespace relume::cuda {
namespace {

using testing::StubDriver;
using Kind = DeviceChoice::Kind;

std::string error_of(const std::string& value) {
  try {
    open_chosen_device(value);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(DeviceChoice, HasFourForms) {
  EXPECT_EQ(parse_device("cpu").kind, Kind::host);
  EXPECT_EQ(parse_device("auto").kind, Kind::automatic);
  EXPECT_EQ(parse_device("cuda").kind, Kind::gpu);
  EXPECT_EQ(parse_device("cuda").index, 0);
  EXPECT_EQ(parse_device("cuda:12").kind, Kind::gpu);
  EXPECT_EQ(parse_device("cuda:12").index, 12);
}

TEST(DeviceChoice, RefusesOtherForms) {
  for (const char* value : {"", "gpu", "CUDA", "cuda:", "cuda:x", "cuda:1x", "cuda:-1", "cuda:99999999999", "cuda 1"}) {
    EXPECT_EQ(error_of(value), std::string("--device is '") + value +
                                   "', but must be cpu, auto, cuda, or cuda:N with the number of a GPU (relume devices "
                                   "lists them)");
  }
}

TEST(DeviceChoice, NeedsNoDriverForTheHost) {
  const StubDriver stub;
  const size_t calls = StubDriver::calls("cuInit");
  EXPECT_EQ(open_chosen_device("cpu"), nullptr);
  EXPECT_EQ(StubDriver::calls("cuInit"), calls);
  EXPECT_EQ(StubDriver::calls("cuDeviceGetCount"), 0u);
}

TEST(DeviceChoice, FallsBackToTheHostOnlyIfItIsAutomatic) {
  const StubDriver stub("capability=70");
  EXPECT_EQ(open_chosen_device("auto"), nullptr);
  EXPECT_NE(error_of("cuda").find("compute capability is 7.0"), std::string::npos) << error_of("cuda");
  EXPECT_NE(error_of("cuda:3").find("there is no GPU 3"), std::string::npos) << error_of("cuda:3");
}

TEST(DeviceChoice, FallsBackToTheHostIfAGpuHasNoMemory) {
  const StubDriver stub;
  StubDriver::configure("fail=cuStreamCreate:1:2");
  EXPECT_EQ(open_chosen_device("auto"), nullptr);
  StubDriver::configure("fail=cuStreamCreate:1:2");
  EXPECT_THROW(open_chosen_device("cuda"), DeviceMemoryError);
}

TEST(DeviceChoice, RefusesUnknownValuesOfTheVariable) {
  const StubDriver stub;
  for (const char* value : {"0", "1"}) {
    ::setenv("RELUME_CUDA_GRAPHS", value, 1);
    EXPECT_EQ(error_of("cuda"), "no error");
  }
  ::setenv("RELUME_CUDA_GRAPHS", "off", 1);
  const std::string error =
      "RELUME_CUDA_GRAPHS is 'off', but must be 0 (launches without CUDA graphs) or 1; unset it for 1";
  EXPECT_EQ(error_of("cuda"), error);
  EXPECT_EQ(error_of("cuda:0"), error);
  EXPECT_EQ(error_of("cpu"), "no error");
  ::unsetenv("RELUME_CUDA_GRAPHS");
}

TEST(DeviceChoice, ResolvesAutoToTheGpuThatOpens) {
  const StubDriver stub("devices=2");
  EXPECT_EQ(resolved_device("auto"), "cuda:0");
  StubDriver::configure("devices=2 fail=cuStreamCreate:1:2");
  EXPECT_EQ(resolved_device("auto"), "cuda:1");
  StubDriver::configure("devices=0");
  EXPECT_EQ(resolved_device("auto"), "cpu");
  for (const char* value : {"cpu", "cuda", "cuda:3"}) EXPECT_EQ(resolved_device(value), value);
  EXPECT_THROW(resolved_device("gpu"), Error);
}

}  // namespace
}  // namespace relume::cuda
