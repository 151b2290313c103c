// NVIDIA's driver: the functions of its programming interface that relume calls, found at run time in libcuda.so.1.
// They are declared here, so that builds need nothing of NVIDIA's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace relume::cuda {

/// Result of a function of the driver (CUresult). It may return others, too.
enum class Result : int {
  success = 0,
  invalid_value = 1,
  out_of_memory = 2,
  stub_library = 34,
  device_unavailable = 46,
  no_device = 100,
  invalid_device = 101,
  no_binary_for_device = 209,
  ecc_uncorrectable = 214,
  invalid_ptx = 218,
  nvlink_uncorrectable = 220,
  jit_compiler_not_found = 221,
  unsupported_ptx_version = 222,
  jit_compilation_disabled = 223,
  contained = 226,
  not_ready = 600,
  illegal_address = 700,
  launch_out_of_resources = 701,
  launch_timeout = 702,
  context_is_destroyed = 709,
  device_assert = 710,
  hardware_stack_error = 714,
  illegal_instruction = 715,
  misaligned_address = 716,
  invalid_address_space = 717,
  invalid_pc = 718,
  launch_failed = 719,
  tensor_memory_leak = 721,
  system_not_ready = 802,
  system_driver_mismatch = 803,
  compat_not_supported_on_device = 804,
  mps_client_terminated = 810,
  external_device = 911,
  unknown = 999,
};

/// Property of a device (CUdevice_attribute).
enum class DeviceAttribute : int {
  multiprocessor_count = 16,
  compute_mode = 20,
  max_threads_per_multiprocessor = 39,
  compute_capability_major = 75,
  compute_capability_minor = 76,
  managed_memory = 83,
  concurrent_managed_access = 89,
};

/// Property of a kernel (CUfunction_attribute).
enum class FunctionAttribute : int {
  local_size_bytes = 3,
};

/// Option of the driver's compiler (CUjit_option).
enum class CompilerOption : int {
  error_log_buffer = 5,
  error_log_buffer_size_bytes = 6,
};

/// The compute mode of a device on which processes must not run kernels (CUcomputemode).
inline constexpr int kComputeModeProhibited = 2;
/// The processor, as a destination of cuMemPrefetchAsync() (CU_DEVICE_CPU).
inline constexpr int kHostDevice = -1;
/// Managed memory for all streams of all devices (CU_MEM_ATTACH_GLOBAL).
inline constexpr unsigned kAttachGlobal = 1;
/// A stream that does not wait for the default stream (CU_STREAM_NON_BLOCKING).
inline constexpr unsigned kStreamNonBlocking = 1;
/// An event on which the host waits without occupying a core (CU_EVENT_BLOCKING_SYNC).
inline constexpr unsigned kEventBlockingSync = 1;
/// A capture that forbids calls which could break it to its own thread only (CU_STREAM_CAPTURE_MODE_THREAD_LOCAL).
inline constexpr int kCaptureThreadLocal = 1;
/// A captured event becomes a node, which records it in each launch of the graph (CU_EVENT_RECORD_EXTERNAL).
inline constexpr unsigned kEventRecordExternal = 1;

/// A texture of OpenGL with two dimensions (GL_TEXTURE_2D).
inline constexpr unsigned kTexture2d = 0x0de1;
/// All devices of an OpenGL context (CU_GL_DEVICE_LIST_ALL).
inline constexpr int kAllGlDevices = 1;
/// A texture that only the device writes, as a whole (CU_GRAPHICS_REGISTER_FLAGS_WRITE_DISCARD).
inline constexpr unsigned kWriteDiscard = 2;

// Objects of the driver.
using DeviceNumber = int;
using DeviceAddress = unsigned long long;
struct ContextObject;
struct ModuleObject;
struct FunctionObject;
struct StreamObject;
struct EventObject;
struct GraphObject;
struct GraphExecutionObject;
struct GraphNodeObject;
struct TextureObject;
struct ArrayObject;
using Context = ContextObject*;
using Module = ModuleObject*;
using Function = FunctionObject*;
using Stream = StreamObject*;
using Event = EventObject*;
using Graph = GraphObject*;
using GraphExecution = GraphExecutionObject*;
using GraphNode = GraphNodeObject*;
using Texture = TextureObject*;
using TextureArray = ArrayObject*;

/// Kind of memory in a copy (CUmemorytype).
enum class MemoryType : int {
  device = 2,
  array = 3,
};

/// A copy of rows of bytes (CUDA_MEMCPY2D).
struct RowCopy {
  struct End {
    size_t x_bytes = 0;
    size_t y = 0;
    MemoryType type = MemoryType::device;
    const void* host = nullptr;
    DeviceAddress device = 0;
    TextureArray array = nullptr;
    size_t pitch_bytes = 0;  ///< from row to row; not for arrays
  };
  End from;
  End to;
  size_t row_bytes = 0;
  size_t rows = 0;
};

/// Version of the driver's interface that PTX 6.3 needs, as cuDriverGetVersion() writes it: 10.0.
inline constexpr int kMinDriverVersion = 10000;

/// The functions, with the driver's names for them.
struct Driver {
  Result (*cuGetErrorName)(Result result, const char** name) = nullptr;
  Result (*cuGetErrorString)(Result result, const char** text) = nullptr;
  Result (*cuInit)(unsigned flags) = nullptr;
  Result (*cuDriverGetVersion)(int* version) = nullptr;

  Result (*cuDeviceGetCount)(int* count) = nullptr;
  Result (*cuDeviceGet)(DeviceNumber* device, int index) = nullptr;
  Result (*cuDeviceGetName)(char* name, int bytes, DeviceNumber device) = nullptr;
  Result (*cuDeviceTotalMem)(size_t* bytes, DeviceNumber device) = nullptr;
  Result (*cuDeviceGetAttribute)(int* value, DeviceAttribute attribute, DeviceNumber device) = nullptr;

  Result (*cuDevicePrimaryCtxRetain)(Context* context, DeviceNumber device) = nullptr;
  Result (*cuDevicePrimaryCtxRelease)(DeviceNumber device) = nullptr;
  Result (*cuCtxPushCurrent)(Context context) = nullptr;
  Result (*cuCtxPopCurrent)(Context* context) = nullptr;

  Result (*cuMemGetInfo)(size_t* free, size_t* total) = nullptr;
  Result (*cuMemAllocManaged)(DeviceAddress* address, size_t bytes, unsigned flags) = nullptr;
  Result (*cuMemAlloc)(DeviceAddress* address, size_t bytes) = nullptr;
  Result (*cuMemFree)(DeviceAddress address) = nullptr;
  Result (*cuMemHostAlloc)(void** address, size_t bytes, unsigned flags) = nullptr;
  Result (*cuMemFreeHost)(void* address) = nullptr;
  /// Its first form: the second one needs driver 12.2.
  Result (*cuMemPrefetchAsync)(DeviceAddress address, size_t bytes, DeviceNumber to, Stream stream) = nullptr;
  Result (*cuMemcpyHtoDAsync)(DeviceAddress to, const void* from, size_t bytes, Stream stream) = nullptr;
  Result (*cuMemcpyDtoDAsync)(DeviceAddress to, DeviceAddress from, size_t bytes, Stream stream) = nullptr;
  Result (*cuMemcpyDtoHAsync)(void* to, DeviceAddress from, size_t bytes, Stream stream) = nullptr;
  Result (*cuMemsetD8Async)(DeviceAddress to, unsigned char value, size_t bytes, Stream stream) = nullptr;

  Result (*cuModuleLoadDataEx)(Module* module, const void* image, unsigned options, CompilerOption* names,
                               void** values) = nullptr;
  Result (*cuModuleUnload)(Module module) = nullptr;
  Result (*cuModuleGetFunction)(Function* function, Module module, const char* name) = nullptr;
  Result (*cuModuleGetGlobal)(DeviceAddress* address, size_t* bytes, Module module, const char* name) = nullptr;
  Result (*cuFuncGetAttribute)(int* value, FunctionAttribute attribute, Function function) = nullptr;
  Result (*cuLaunchKernel)(Function function, unsigned grid_x, unsigned grid_y, unsigned grid_z, unsigned block_x,
                           unsigned block_y, unsigned block_z, unsigned shared_bytes, Stream stream, void** parameters,
                           void** extra) = nullptr;

  Result (*cuStreamCreate)(Stream* stream, unsigned flags) = nullptr;
  Result (*cuStreamDestroy)(Stream stream) = nullptr;
  Result (*cuStreamSynchronize)(Stream stream) = nullptr;
  Result (*cuStreamWaitEvent)(Stream stream, Event event, unsigned flags) = nullptr;

  Result (*cuEventCreate)(Event* event, unsigned flags) = nullptr;
  Result (*cuEventDestroy)(Event event) = nullptr;
  Result (*cuEventRecord)(Event event, Stream stream) = nullptr;
  Result (*cuEventQuery)(Event event) = nullptr;
  Result (*cuEventSynchronize)(Event event) = nullptr;
  Result (*cuEventElapsedTime)(float* milliseconds, Event begin, Event end) = nullptr;

  // Graphs. nullptr if the driver lacks them: cuEventRecordWithFlags needs CUDA 11.1, the others need less.
  Result (*cuStreamBeginCapture)(Stream stream, int mode) = nullptr;
  Result (*cuStreamEndCapture)(Stream stream, Graph* graph) = nullptr;
  Result (*cuEventRecordWithFlags)(Event event, Stream stream, unsigned flags) = nullptr;
  Result (*cuGraphInstantiate)(GraphExecution* execution, Graph graph, GraphNode* failed, char* log,
                               size_t log_bytes) = nullptr;
  /// Its first form: the second one needs driver 12.0.
  Result (*cuGraphExecUpdate)(GraphExecution execution, Graph graph, GraphNode* failed, int* reason) = nullptr;
  Result (*cuGraphLaunch)(GraphExecution execution, Stream stream) = nullptr;
  Result (*cuGraphExecDestroy)(GraphExecution execution) = nullptr;
  Result (*cuGraphDestroy)(Graph graph) = nullptr;

  // Textures of OpenGL. nullptr if the driver lacks them.
  Result (*cuMemcpy2DAsync)(const RowCopy* copy, Stream stream) = nullptr;
  Result (*cuGLGetDevices)(unsigned* count, DeviceNumber* devices, unsigned most, int list) = nullptr;
  Result (*cuGraphicsGLRegisterImage)(Texture* texture, unsigned name, unsigned target, unsigned flags) = nullptr;
  Result (*cuGraphicsUnregisterResource)(Texture texture) = nullptr;
  Result (*cuGraphicsMapResources)(unsigned count, Texture* textures, Stream stream) = nullptr;
  Result (*cuGraphicsUnmapResources)(unsigned count, Texture* textures, Stream stream) = nullptr;
  Result (*cuGraphicsSubResourceGetMappedArray)(TextureArray* array, Texture texture, unsigned index,
                                                unsigned level) = nullptr;

  /// Whether the driver has all functions of graphs, and of textures.
  bool has_graphs() const;
  bool has_textures() const;

  /// Calls f(symbol, function) for each function, with its name in the library.
  template <typename F>
  void for_each_function(const F& f);
};

/// The driver of the system, loaded on the first call that finds it. Throws Error if it is missing or too old.
/// Thread-safe.
const Driver& driver();

/// Loads a driver from a library, which stays loaded. Throws Error.
Driver load_driver(const std::string& library);

/// Initialises a driver, if it is not yet. Returns false if it finds no GPU. Throws Error if it cannot be used.
bool start(const Driver& driver);

/// "CUDA_ERROR_OUT_OF_MEMORY (out of memory)".
std::string describe(const Driver& driver, Result result);

/// An action of the user against an error, as the end of a sentence: "install …".
std::string_view remedy(Result result);

/// Throws Error unless `result` is success: "`action` failed: NAME (text); remedy".
void check(const Driver& driver, Result result, std::string_view action);

/// A version of the driver's interface, such as "12.4" for 12040.
std::string version_text(int version);

/// X(member, symbol) for each function that relume needs: its member of Driver, and its name in the library.
#define RELUME_CUDA_FUNCTIONS(X)                             \
  X(cuGetErrorName, cuGetErrorName)                          \
  X(cuGetErrorString, cuGetErrorString)                      \
  X(cuInit, cuInit)                                          \
  X(cuDriverGetVersion, cuDriverGetVersion)                  \
  X(cuDeviceGetCount, cuDeviceGetCount)                      \
  X(cuDeviceGet, cuDeviceGet)                                \
  X(cuDeviceGetName, cuDeviceGetName)                        \
  X(cuDeviceTotalMem, cuDeviceTotalMem_v2)                   \
  X(cuDeviceGetAttribute, cuDeviceGetAttribute)              \
  X(cuDevicePrimaryCtxRetain, cuDevicePrimaryCtxRetain)      \
  X(cuDevicePrimaryCtxRelease, cuDevicePrimaryCtxRelease_v2) \
  X(cuCtxPushCurrent, cuCtxPushCurrent_v2)                   \
  X(cuCtxPopCurrent, cuCtxPopCurrent_v2)                     \
  X(cuMemGetInfo, cuMemGetInfo_v2)                           \
  X(cuMemAllocManaged, cuMemAllocManaged)                    \
  X(cuMemAlloc, cuMemAlloc_v2)                               \
  X(cuMemFree, cuMemFree_v2)                                 \
  X(cuMemHostAlloc, cuMemHostAlloc)                          \
  X(cuMemFreeHost, cuMemFreeHost)                            \
  X(cuMemPrefetchAsync, cuMemPrefetchAsync)                  \
  X(cuMemcpyHtoDAsync, cuMemcpyHtoDAsync_v2)                 \
  X(cuMemcpyDtoDAsync, cuMemcpyDtoDAsync_v2)                 \
  X(cuMemcpyDtoHAsync, cuMemcpyDtoHAsync_v2)                 \
  X(cuMemsetD8Async, cuMemsetD8Async)                        \
  X(cuModuleLoadDataEx, cuModuleLoadDataEx)                  \
  X(cuModuleUnload, cuModuleUnload)                          \
  X(cuModuleGetFunction, cuModuleGetFunction)                \
  X(cuModuleGetGlobal, cuModuleGetGlobal_v2)                 \
  X(cuFuncGetAttribute, cuFuncGetAttribute)                  \
  X(cuLaunchKernel, cuLaunchKernel)                          \
  X(cuStreamCreate, cuStreamCreate)                          \
  X(cuStreamDestroy, cuStreamDestroy_v2)                     \
  X(cuStreamSynchronize, cuStreamSynchronize)                \
  X(cuStreamWaitEvent, cuStreamWaitEvent)                    \
  X(cuEventCreate, cuEventCreate)                            \
  X(cuEventDestroy, cuEventDestroy_v2)                       \
  X(cuEventRecord, cuEventRecord)                            \
  X(cuEventQuery, cuEventQuery)                              \
  X(cuEventSynchronize, cuEventSynchronize)                  \
  X(cuEventElapsedTime, cuEventElapsedTime)

/// The same for the functions of graphs, under their oldest names that take these parameters.
#define RELUME_CUDA_GRAPH_FUNCTIONS(X)              \
  X(cuStreamBeginCapture, cuStreamBeginCapture_v2)  \
  X(cuStreamEndCapture, cuStreamEndCapture)         \
  X(cuEventRecordWithFlags, cuEventRecordWithFlags) \
  X(cuGraphInstantiate, cuGraphInstantiate_v2)      \
  X(cuGraphExecUpdate, cuGraphExecUpdate)           \
  X(cuGraphLaunch, cuGraphLaunch)                   \
  X(cuGraphExecDestroy, cuGraphExecDestroy)         \
  X(cuGraphDestroy, cuGraphDestroy)

/// The same for the functions of textures.
#define RELUME_CUDA_TEXTURE_FUNCTIONS(X)                        \
  X(cuMemcpy2DAsync, cuMemcpy2DAsync_v2)                        \
  X(cuGLGetDevices, cuGLGetDevices_v2)                          \
  X(cuGraphicsGLRegisterImage, cuGraphicsGLRegisterImage)       \
  X(cuGraphicsUnregisterResource, cuGraphicsUnregisterResource) \
  X(cuGraphicsMapResources, cuGraphicsMapResources)             \
  X(cuGraphicsUnmapResources, cuGraphicsUnmapResources)         \
  X(cuGraphicsSubResourceGetMappedArray, cuGraphicsSubResourceGetMappedArray)

template <typename F>
void Driver::for_each_function(const F& f) {
#define RELUME_VISIT(member, symbol) f(#symbol, member);
  RELUME_CUDA_FUNCTIONS(RELUME_VISIT)
  RELUME_CUDA_GRAPH_FUNCTIONS(RELUME_VISIT)
  RELUME_CUDA_TEXTURE_FUNCTIONS(RELUME_VISIT)
#undef RELUME_VISIT
}

}  // namespace relume::cuda
