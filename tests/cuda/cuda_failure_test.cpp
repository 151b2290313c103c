// Failures of the CUDA backend on the stub driver: devices that fail during a frame, code that does not fit, errors at
// every step of opening a device, and in each function of the driver.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/array.h"
#include "frame/cuda/cuda_device.h"
#include "frame/device_display.h"
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
using testing::TrapKernel;

std::unique_ptr<Device> open(const StubDriver& stub) { return open_device(stub.driver(), testing::test_device_code()); }

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::exception& error) {
    return error.what();
  }
  return "no error";
}

/// The sentence after the loss of a device, if `launch` is the first that may not have ended.
std::string lost_in(const std::string& launch) {
  return "Stub GPU 0 (cuda:0) failed in or after the launch of '" + launch +
         "': CUDA_ERROR_LAUNCH_FAILED (unspecified launch failure); start relume again, or use --device cpu";
}

/// A device that has failed in the second of three launches.
class LostCudaDeviceTest : public ::testing::Test {
 protected:
  LostCudaDeviceTest() {
    values_.assign(16, 0);
    for (const char* name : {"first", "second", "third"}) {
      queue(*device_, AddKernel{1, values_.mutable_view()}, {0, 0, 16, 1}, name);
    }
  }

  StubDriver stub_{"lose=2"};
  std::unique_ptr<Device> device_ = open(stub_);
  Array<uint32_t> values_{device_->memory()};
};

TEST_F(LostCudaDeviceTest, FailsForever) {
  const std::string lost = lost_in("first");
  EXPECT_EQ(error_of([&] { device_->finish(); }), lost);
  EXPECT_EQ(error_of([&] { device_->finish(); }), lost);
  EXPECT_EQ(error_of([&] { device_->wait(0); }), lost);
  EXPECT_EQ(error_of([&] { device_->take_times(); }), lost);
  EXPECT_EQ(error_of([&] { queue(*device_, AddKernel{1, values_.mutable_view()}, {0, 0, 16, 1}); }), lost);
}

TEST_F(LostCudaDeviceTest, IsNoticedByTheMemory) {
  const std::string lost = lost_in("first");
  EXPECT_EQ(error_of([&] { values_.read(); }), lost);
  EXPECT_EQ(error_of([&] { values_.write(); }), lost);
  EXPECT_EQ(error_of([&] { values_.permit_reading(); }), lost);
  EXPECT_EQ(error_of([&] { device_->memory().zero(values_.mutable_view().data, 4); }), lost);
  EXPECT_EQ(error_of([&] { Array<uint32_t>(device_->memory()).assign(5, 1); }), lost);
}

TEST_F(LostCudaDeviceTest, IsNoticedByTimes) {
  EXPECT_EQ(error_of([&] {
              for (int i = 0; i < 100; ++i) device_->take_times();
            }),
            lost_in("second"))
      << "the first launch is known to have ended";
}

TEST_F(LostCudaDeviceTest, EndsTheProcess) {
  EXPECT_THROW(device_->finish(), Error);
  values_ = Array<uint32_t>();
  device_.reset();
  EXPECT_EQ(StubDriver::objects("contexts"), 0u);
  EXPECT_EQ(error_of([&] { open(stub_); }),
            "Stub GPU 0 (cuda:0) failed: CUDA_ERROR_LAUNCH_FAILED (unspecified launch failure); start relume again, or "
            "use --device cpu")
      << "the driver returns the error until the process ends";
}

TEST(CudaFailure, IsAnErrorThatIsContained) {
  const StubDriver stub("fail=cuEventSynchronize:1:226");
  const std::unique_ptr<Device> device = open(stub);
  queue(*device, TrapKernel{}, {0, 0, 1, 1}, "draw");
  const std::string first = error_of([&] { device->finish(); });
  EXPECT_NE(first.find("failed in or after the launch of 'draw': CUDA_ERROR_CONTAINED"), std::string::npos) << first;
  EXPECT_EQ(error_of([&] { device->memory().allocate(5, 1); }), first);
}

TEST(CudaFailure, IsATrapOfAKernel) {
  const StubDriver stub;
  const std::unique_ptr<Device> device = open(stub);
  queue(*device, TrapKernel{}, {0, 0, 1, 1}, "trap");
  EXPECT_NE(error_of([&] { device->finish(); }).find("failed in or after the launch of 'trap'"), std::string::npos);
}

TEST(CudaFailure, OfALaunchIsSurvived) {
  const StubDriver stub("fail=cuLaunchKernel:2:2");
  const std::unique_ptr<Device> device = open(stub);
  Array<uint64_t> values(device->memory());
  values.assign(1, 0);
  queue(*device, AppendKernel{values.mutable_view(), 1}, {0, 0, 1, 1});
  const AppendKernel second{values.mutable_view(), 2};
  EXPECT_THROW(queue(*device, second, {0, 0, 1, 1}), DeviceMemoryError);
  queue(*device, second, {0, 0, 1, 1});
  EXPECT_EQ(values.read()[0], 33u);
  device->finish();
  EXPECT_EQ(device->take_times().size(), 2u);
}

TEST(CudaFailure, OfACopyIsSurvived) {
  const StubDriver stub("fail=cuMemcpyHtoDAsync_v2:2:1");
  const std::unique_ptr<Device> device = open(stub);
  Array<uint64_t> values(device->memory());
  values.assign(1, 0);
  queue(*device, AppendKernel{values.mutable_view(), 1}, {0, 0, 1, 1});
  const AppendKernel second{values.mutable_view(), 2};
  EXPECT_THROW(queue(*device, second, {0, 0, 1, 1}), Error);
  queue(*device, second, {0, 0, 1, 1});
  EXPECT_EQ(values.read()[0], 33u);
}

TEST(CudaFailure, IsCodeThatTheDriverRefuses) {
  const StubDriver stub;
  EXPECT_EQ(
      error_of([&] { open_device(stub.driver(), "no device code"); }),
      "Stub GPU 0 (cuda:0): compiling the kernels ('ptxas fatal   : Missing .version directive at start of file') "
      "failed: CUDA_ERROR_INVALID_PTX (a PTX JIT compilation failed); install a newer driver, or use --device "
      "cpu");
  EXPECT_EQ(error_of([&] { open_device(stub.driver(), ""); }),
            "this build of relume has no device code; build it with clang and RELUME_CUDA=ON, or use --device cpu");
}

TEST(CudaFailure, IsAGpuThatCannotBeUsed) {
  const StubDriver stub("capability=61");
  EXPECT_EQ(error_of([&] { open(stub); }),
            "Stub GPU 0 (cuda:0) cannot be used: its compute capability is 6.1, but relume needs 7.5; use another GPU "
            "or --device cpu");
}

TEST(CudaFailure, IsAKernelThatTheCodeLacks) {
  const StubDriver stub;
  const std::unique_ptr<Device> device = open(stub);
  const auto launch = [&](const DeviceLaunch& wanted) { return error_of([&] { device->launch(wanted); }); };
  const Tile window{0, 0, 1, 1};
  EXPECT_EQ(launch({"test", "relume::NoKernel", 0, {}, window}),
            "the device code has no kernel relume::NoKernel; add it to the kernels.inc of its folder");
  EXPECT_NE(launch({"test", kernel_type_name<RowSumKernel>(), 0, {}, window}).find("as a group kernel"),
            std::string::npos);
  EXPECT_NE(launch({"test", kernel_type_name<AddKernel>(), 64, {}, window}).find("as a pass kernel"),
            std::string::npos);
  const std::vector<std::byte> large(5000);
  EXPECT_NE(launch({"test", kernel_type_name<AddKernel>(), 0, large, window}).find("5000"), std::string::npos);
}

/// A call that fails while a device is opened.
struct FailingCall {
  const char* call;   ///< function, number of the call, result
  const char* parts;  ///< of the sentence: action, and remedy after "…"
};

class OpeningCudaDeviceTest : public ::testing::TestWithParam<FailingCall> {};

TEST_P(OpeningCudaDeviceTest, FailsWithoutLeaks) {
  const StubDriver stub;
  StubDriver::configure(std::string("fail=") + GetParam().call);
  std::string sentence;
  try {
    open(stub);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::device);
    sentence = error.what();
  } catch (const DeviceMemoryError& error) {
    EXPECT_NE(std::string(GetParam().call).find(":2"), std::string::npos) << "out of memory";
    sentence = error.what();
  }
  const std::string parts = GetParam().parts;
  const size_t end = parts.find("…");
  EXPECT_NE(sentence.find(parts.substr(0, end) + " failed: CUDA_ERROR_"), std::string::npos) << sentence;
  EXPECT_TRUE(sentence.ends_with("; " + parts.substr(end + std::string("…").size()))) << sentence;
  EXPECT_EQ(StubDriver::objects("contexts"), 0u);
  EXPECT_EQ(StubDriver::objects("leaked"), 0u);
  EXPECT_NO_THROW(open(stub));
}

#define AGAIN "…start relume again, or use --device cpu"
#define LESS "…use a smaller image or scene, or end other programs that use the GPU"
INSTANTIATE_TEST_SUITE_P(
    Steps, OpeningCudaDeviceTest,
    ::testing::Values(
        FailingCall{"cuInit:1:803",
                    "starting the CUDA driver…restart the machine, so that the driver's library and kernel module have "
                    "one version"},
        FailingCall{"cuDeviceGetCount:1:999",
                    "counting the GPUs…check that nvidia-smi works and that the kernel module nvidia_uvm is loaded"},
        FailingCall{"cuDeviceGet:1:101", "opening GPU 0" AGAIN},
        FailingCall{"cuDeviceGetName:1:1", "asking GPU 0 for its name" AGAIN},
        FailingCall{"cuDeviceTotalMem_v2:1:1", "asking for the memory of Stub GPU 0" AGAIN},
        FailingCall{"cuDeviceGetAttribute:3:1", "asking a GPU for its attribute 16" AGAIN},
        FailingCall{"cuDevicePrimaryCtxRetain:1:46",
                    "starting Stub GPU 0 (cuda:0)…end the program that uses the GPU exclusively, or use --device cpu"},
        FailingCall{"cuCtxPushCurrent_v2:1:201", "using Stub GPU 0 (cuda:0)" AGAIN},
        FailingCall{"cuStreamCreate:1:2", "creating a queue" LESS},
        FailingCall{"cuModuleLoadDataEx:1:2", "compiling the kernels" LESS},
        FailingCall{"cuModuleGetFunction:2:500", "AppendKernel" AGAIN},
        FailingCall{"cuFuncGetAttribute:1:1", "AddKernel" AGAIN},
        FailingCall{"cuModuleGetGlobal_v2:1:500", "finding the constant 'relume_kernel'" AGAIN},
        FailingCall{"cuMemHostAlloc:1:2", "allocating page-locked memory" LESS},
        FailingCall{"cuEventCreate:1:2", "creating an event" LESS},
        FailingCall{"cuEventCreate:7:2", "creating an event" LESS},
        FailingCall{"cuMemGetInfo_v2:1:1", "asking for the free memory" AGAIN}),
    [](const auto& tested) {
      std::string name = tested.param.call;
      std::replace(name.begin(), name.end(), ':', '_');
      return name;
    });
#undef AGAIN
#undef LESS

/// Names in the library of all functions of the driver, except the two that describe errors.
std::vector<std::string> function_names() {
  std::vector<std::string> names;
  Driver().for_each_function([&](const char* symbol, const auto&) {
    if (!std::string_view(symbol).starts_with("cuGetError")) names.emplace_back(symbol);
  });
  return names;
}

bool is_one_of(const std::string& name, std::initializer_list<std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

/// Brings two images to a window: one through page-locked memory, and one that stays on the device. Errors that the
/// device survives only make it return less.
void show(Device& device, const Array<uint32_t>& pixels) {
  constexpr size_t kRowBytes = 400;
  constexpr size_t kRows = 2;
  constexpr unsigned kName = 7;
  StubDriver::make_texture(kName, kRowBytes, kRows);
  for (const bool stays : {false, true}) {
    const std::shared_ptr<DeviceImage> image = device.copy_image(pixels.view().data, kRows * kRowBytes);
    if (!image) continue;
    image->bytes();
    std::byte first{};
    image->read(0, std::span(&first, 1));
    image->display()->keep_on_device(true);
    if (!stays) continue;
    const std::unique_ptr<DeviceTexture> texture = image->display()->share(kName, kRowBytes, kRows);
    if (texture) texture->write(*image);
  }
}

/// Opens a device, works with it, and closes it, which calls all these functions.
void use_device(const StubDriver& stub) {
  constexpr uint32_t kElements = 32 * 1024;  // in blocks that are large enough to be moved as a whole
  const std::unique_ptr<Device> device = open(stub);
  Array<uint32_t> from(device->memory());
  Array<uint32_t> to(device->memory());
  from.assign(kElements, 1);
  to.assign(kElements, 0);
  queue(*device, AddKernel{1, from.mutable_view()}, {0, 0, kElements, 1});
  device->memory().zero(from.mutable_view().data, sizeof(uint32_t));
  device->memory().copy(to.mutable_view().data, from.view().data, kElements * sizeof(uint32_t));
  device->take_times();
  EXPECT_EQ(to.read()[0], 0u);
  EXPECT_EQ(to.read()[1], 2u);
  show(*device, to);
  // A sequence is launched without a graph, then captured, and then updates the graph.
  for (const uint32_t elements : {100u, 100u, 200u}) {
    queue_waiting(*device, AddKernel{1, to.mutable_view()}, {0, 0, elements, 1});
    queue_waiting(*device, AddKernel{2, to.mutable_view()}, {0, 0, elements, 1});
    device->finish();
  }
  EXPECT_EQ(to.read()[1], 11u);
  device->take_times();
}

class DriverFunctionTest : public ::testing::TestWithParam<std::string> {
 protected:
  ~DriverFunctionTest() override { clean_up(); }
  /// Ends the failure, and frees what it left in the driver.
  void clean_up() {
    StubDriver::configure("");
    Context context = nullptr;
    while (stub_.driver().cuCtxPopCurrent(&context) == Result::success) {
    }
    if (StubDriver::objects("contexts") > 0) stub_.driver().cuDevicePrimaryCtxRelease(0);
  }

  StubDriver stub_;
};

/// The first call fails with an error that the device survives, for lack of memory, and because the device is lost.
TEST_P(DriverFunctionTest, FailsOnce) {
  const std::string& function = GetParam();
  const bool frees =
      is_one_of(function, {"cuMemFree_v2", "cuMemFreeHost", "cuModuleUnload", "cuStreamDestroy_v2", "cuEventDestroy_v2",
                           "cuGraphExecDestroy", "cuGraphDestroy", "cuGraphicsUnregisterResource"});
  const bool releases = function == "cuDevicePrimaryCtxRelease_v2";
  // Destructors ignore errors. After the loss of the device, the next call fails, too.
  // Launches need no graphs, and windows need no images on the device.
  const bool is_optional = is_one_of(
      function, {"cuStreamBeginCapture_v2", "cuStreamEndCapture", "cuEventRecordWithFlags", "cuGraphInstantiate_v2",
                 "cuGraphExecUpdate", "cuGraphLaunch", "cuMemAlloc_v2", "cuMemcpyDtoHAsync_v2", "cuStreamWaitEvent",
                 "cuMemcpy2DAsync_v2", "cuGLGetDevices_v2", "cuGraphicsGLRegisterImage", "cuGraphicsMapResources",
                 "cuGraphicsUnmapResources", "cuGraphicsSubResourceGetMappedArray"});
  const bool in_destructors = frees || releases || is_one_of(function, {"cuCtxPopCurrent_v2", "cuStreamSynchronize"});
  for (const auto& [result, name] : {std::pair(1, "CUDA_ERROR_INVALID_VALUE"), std::pair(2, "CUDA_ERROR_OUT_OF_MEMORY"),
                                     std::pair(719, "CUDA_ERROR_LAUNCH_FAILED")}) {
    SCOPED_TRACE(name);
    const bool is_lost = result == 719;
    const bool is_followed =
        is_one_of(function, {"cuCtxPopCurrent_v2", "cuGraphDestroy", "cuGraphicsUnregisterResource"});
    const bool is_ignored = (in_destructors || is_optional) && !(is_lost && (is_optional || is_followed));
    StubDriver::configure("fail=" + function + ":1:" + std::to_string(result));
    const std::string error = error_of([&] { use_device(stub_); });
    EXPECT_GT(StubDriver::calls(function.c_str()), 0u);
    const bool names_it = error.find("failed") != std::string::npos && error.find(name) != std::string::npos;
    EXPECT_EQ(error == "no error", is_ignored) << error;
    EXPECT_EQ(names_it, !is_ignored) << error;
    EXPECT_EQ(StubDriver::objects("leaked"), frees && !is_lost ? 1u : 0u) << "only what it should have freed";
    EXPECT_EQ(StubDriver::objects("contexts"), releases ? 1u : 0u);
    clean_up();
    EXPECT_EQ(error_of([&] { use_device(stub_); }), "no error");
  }
}

INSTANTIATE_TEST_SUITE_P(All, DriverFunctionTest, ::testing::ValuesIn(function_names()),
                         [](const auto& tested) { return tested.param; });

}  // namespace
}  // namespace relume::cuda
