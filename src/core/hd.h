// Marks functions that run on the host and, in a CUDA build, on the device.
#pragma once

#if defined(__CUDACC__)
#define RELUME_HD __host__ __device__
#else
#define RELUME_HD
#endif

// The same, inlined whatever the compiler's estimate of the size says. For small functions at the bottom of every
// kernel: whether loops over them become vector code must not depend on what else a translation unit contains.
#if defined(__CUDACC__)
#define RELUME_HD_INLINE __host__ __device__ __forceinline__
#else
#define RELUME_HD_INLINE [[gnu::always_inline]] inline
#endif

// The same, never inlined: for what few surfaces need. Keeps the inlined common path small.
#if defined(__CUDACC__)
#define RELUME_HD_NOINLINE __host__ __device__ __noinline__
#else
#define RELUME_HD_NOINLINE [[gnu::noinline]]
#endif

// True while compiling code that runs on the device. Only src/accel, src/frame and the atomics of
// src/core may look at it.
#if defined(__CUDA_ARCH__)
#define RELUME_DEVICE_CODE 1
#else
#define RELUME_DEVICE_CODE 0
#endif
