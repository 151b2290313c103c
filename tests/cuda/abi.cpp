// Compares the declarations of frame/cuda/driver.h with NVIDIA's header, where it is installed. Compiling is the test.
#include "frame/cuda/driver.h"

#include <cstddef>
#include <type_traits>

#define __CUDA_API_VERSION_INTERNAL  // declares all versions of functions, under their names in the library
#include <cuda.h>
#if __has_include(<GL/gl.h>)
#include <cudaGL.h>
#endif

namespace relume::cuda {
namespace {

/// Whether values of two types are passed in the same way.
template <typename A, typename B>
constexpr bool kSameParameter = sizeof(A) == sizeof(B) && std::is_pointer_v<A> == std::is_pointer_v<B> &&
                                (std::is_integral_v<A> || std::is_enum_v<A>) ==
                                    (std::is_integral_v<B> || std::is_enum_v<B>);

template <typename A, typename B>
constexpr bool kSameFunction = false;
template <typename A, typename... As, typename B, typename... Bs>
requires(sizeof...(As) ==
         sizeof...(Bs)) constexpr bool kSameFunction<A (*)(As...), B (*)(Bs...)> = kSameParameter<A, B> &&
                                                                                   (kSameParameter<As, Bs> && ...);

#define CHECK_FUNCTION(member, symbol) static_assert(kSameFunction<decltype(Driver::member), decltype(&::symbol)>);
RELUME_CUDA_FUNCTIONS(CHECK_FUNCTION)
CHECK_FUNCTION(cuDevicePrimaryCtxRelease, cuDevicePrimaryCtxRelease)  // of old drivers
RELUME_CUDA_GRAPH_FUNCTIONS(CHECK_FUNCTION)
#if __has_include(<GL/gl.h>)
RELUME_CUDA_TEXTURE_FUNCTIONS(CHECK_FUNCTION)
#endif
#undef CHECK_FUNCTION

template <typename A, typename B>
constexpr bool same_value(A a, B b) {
  return static_cast<long long>(a) == static_cast<long long>(b);
}

static_assert(same_value(Result::success, CUDA_SUCCESS));
static_assert(same_value(Result::invalid_value, CUDA_ERROR_INVALID_VALUE));
static_assert(same_value(Result::out_of_memory, CUDA_ERROR_OUT_OF_MEMORY));
static_assert(same_value(Result::stub_library, CUDA_ERROR_STUB_LIBRARY));
static_assert(same_value(Result::device_unavailable, CUDA_ERROR_DEVICE_UNAVAILABLE));
static_assert(same_value(Result::no_device, CUDA_ERROR_NO_DEVICE));
static_assert(same_value(Result::invalid_device, CUDA_ERROR_INVALID_DEVICE));
static_assert(same_value(Result::no_binary_for_device, CUDA_ERROR_NO_BINARY_FOR_GPU));
static_assert(same_value(Result::ecc_uncorrectable, CUDA_ERROR_ECC_UNCORRECTABLE));
static_assert(same_value(Result::invalid_ptx, CUDA_ERROR_INVALID_PTX));
static_assert(same_value(Result::nvlink_uncorrectable, CUDA_ERROR_NVLINK_UNCORRECTABLE));
static_assert(same_value(Result::jit_compiler_not_found, CUDA_ERROR_JIT_COMPILER_NOT_FOUND));
static_assert(same_value(Result::unsupported_ptx_version, CUDA_ERROR_UNSUPPORTED_PTX_VERSION));
static_assert(same_value(Result::jit_compilation_disabled, CUDA_ERROR_JIT_COMPILATION_DISABLED));
static_assert(same_value(Result::contained, CUDA_ERROR_CONTAINED));
static_assert(same_value(Result::not_ready, CUDA_ERROR_NOT_READY));
static_assert(same_value(Result::illegal_address, CUDA_ERROR_ILLEGAL_ADDRESS));
static_assert(same_value(Result::launch_out_of_resources, CUDA_ERROR_LAUNCH_OUT_OF_RESOURCES));
static_assert(same_value(Result::launch_timeout, CUDA_ERROR_LAUNCH_TIMEOUT));
static_assert(same_value(Result::context_is_destroyed, CUDA_ERROR_CONTEXT_IS_DESTROYED));
static_assert(same_value(Result::device_assert, CUDA_ERROR_ASSERT));
static_assert(same_value(Result::hardware_stack_error, CUDA_ERROR_HARDWARE_STACK_ERROR));
static_assert(same_value(Result::illegal_instruction, CUDA_ERROR_ILLEGAL_INSTRUCTION));
static_assert(same_value(Result::misaligned_address, CUDA_ERROR_MISALIGNED_ADDRESS));
static_assert(same_value(Result::invalid_address_space, CUDA_ERROR_INVALID_ADDRESS_SPACE));
static_assert(same_value(Result::invalid_pc, CUDA_ERROR_INVALID_PC));
static_assert(same_value(Result::launch_failed, CUDA_ERROR_LAUNCH_FAILED));
static_assert(same_value(Result::tensor_memory_leak, CUDA_ERROR_TENSOR_MEMORY_LEAK));
static_assert(same_value(Result::system_not_ready, CUDA_ERROR_SYSTEM_NOT_READY));
static_assert(same_value(Result::system_driver_mismatch, CUDA_ERROR_SYSTEM_DRIVER_MISMATCH));
static_assert(same_value(Result::compat_not_supported_on_device, CUDA_ERROR_COMPAT_NOT_SUPPORTED_ON_DEVICE));
static_assert(same_value(Result::mps_client_terminated, CUDA_ERROR_MPS_CLIENT_TERMINATED));
static_assert(same_value(Result::external_device, CUDA_ERROR_EXTERNAL_DEVICE));
static_assert(same_value(Result::unknown, CUDA_ERROR_UNKNOWN));

static_assert(same_value(DeviceAttribute::multiprocessor_count, CU_DEVICE_ATTRIBUTE_MULTIPROCESSOR_COUNT));
static_assert(same_value(DeviceAttribute::compute_mode, CU_DEVICE_ATTRIBUTE_COMPUTE_MODE));
static_assert(same_value(DeviceAttribute::max_threads_per_multiprocessor,
                         CU_DEVICE_ATTRIBUTE_MAX_THREADS_PER_MULTIPROCESSOR));
static_assert(same_value(DeviceAttribute::compute_capability_major, CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MAJOR));
static_assert(same_value(DeviceAttribute::compute_capability_minor, CU_DEVICE_ATTRIBUTE_COMPUTE_CAPABILITY_MINOR));
static_assert(same_value(DeviceAttribute::managed_memory, CU_DEVICE_ATTRIBUTE_MANAGED_MEMORY));
static_assert(same_value(DeviceAttribute::concurrent_managed_access, CU_DEVICE_ATTRIBUTE_CONCURRENT_MANAGED_ACCESS));
static_assert(same_value(FunctionAttribute::local_size_bytes, CU_FUNC_ATTRIBUTE_LOCAL_SIZE_BYTES));
static_assert(same_value(CompilerOption::error_log_buffer, CU_JIT_ERROR_LOG_BUFFER));
static_assert(same_value(CompilerOption::error_log_buffer_size_bytes, CU_JIT_ERROR_LOG_BUFFER_SIZE_BYTES));
static_assert(same_value(kComputeModeProhibited, CU_COMPUTEMODE_PROHIBITED));
static_assert(same_value(kHostDevice, CU_DEVICE_CPU));
static_assert(same_value(kAttachGlobal, CU_MEM_ATTACH_GLOBAL));
static_assert(same_value(kStreamNonBlocking, CU_STREAM_NON_BLOCKING));
static_assert(same_value(kEventBlockingSync, CU_EVENT_BLOCKING_SYNC));
static_assert(same_value(kCaptureThreadLocal, CU_STREAM_CAPTURE_MODE_THREAD_LOCAL));
static_assert(same_value(kEventRecordExternal, CU_EVENT_RECORD_EXTERNAL));
#if __has_include(<GL/gl.h>)
static_assert(same_value(kTexture2d, GL_TEXTURE_2D));
static_assert(same_value(kAllGlDevices, CU_GL_DEVICE_LIST_ALL));
#endif
static_assert(same_value(kWriteDiscard, CU_GRAPHICS_REGISTER_FLAGS_WRITE_DISCARD));
static_assert(same_value(MemoryType::device, CU_MEMORYTYPE_DEVICE));
static_assert(same_value(MemoryType::array, CU_MEMORYTYPE_ARRAY));

static_assert(sizeof(RowCopy) == sizeof(CUDA_MEMCPY2D));
static_assert(offsetof(RowCopy, from.type) == offsetof(CUDA_MEMCPY2D, srcMemoryType));
static_assert(offsetof(RowCopy, from.device) == offsetof(CUDA_MEMCPY2D, srcDevice));
static_assert(offsetof(RowCopy, from.pitch_bytes) == offsetof(CUDA_MEMCPY2D, srcPitch));
static_assert(offsetof(RowCopy, to) == offsetof(CUDA_MEMCPY2D, dstXInBytes));
static_assert(offsetof(RowCopy, to.array) == offsetof(CUDA_MEMCPY2D, dstArray));
static_assert(offsetof(RowCopy, row_bytes) == offsetof(CUDA_MEMCPY2D, WidthInBytes));
static_assert(offsetof(RowCopy, rows) == offsetof(CUDA_MEMCPY2D, Height));

}  // namespace
}  // namespace relume::cuda
