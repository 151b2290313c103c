// Marks functions that run on the host and, in a CUDA build, on the device.
#pragma once

#if defined(__CUDACC__)
#define RELUME_HD __host__ __device__
#else
#define RELUME_HD
#endif

// True while compiling code that runs on the device. Only src/accel, src/backend and the atomics of
// src/core may look at it.
#if defined(__CUDA_ARCH__)
#define RELUME_DEVICE_CODE 1
#else
#define RELUME_DEVICE_CODE 0
#endif
