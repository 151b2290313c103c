// Marks functions that are compiled for the host and for devices.
#pragma once

#if defined(__CUDACC__)
#define RELUME_HD __host__ __device__
#else
#define RELUME_HD
#endif

// The same, always inlined, for the small functions that every kernel uses. Vectorisation of loops over them must not
// depend on the rest of the translation unit.
#if defined(__CUDACC__)
#define RELUME_HD_INLINE __host__ __device__ __forceinline__
#else
#define RELUME_HD_INLINE [[gnu::always_inline]] inline
#endif

// The same, never inlined: keeps rare surface features out of the inlined common path.
#if defined(__CUDACC__)
#define RELUME_HD_NOINLINE __host__ __device__ __attribute__((noinline))
#else
#define RELUME_HD_NOINLINE [[gnu::noinline]]
#endif

// True while compiling device code. Only src/accel, src/frame and the atomics of src/core may use it.
#if defined(__CUDA_ARCH__)
#define RELUME_DEVICE_CODE 1
#else
#define RELUME_DEVICE_CODE 0
#endif
