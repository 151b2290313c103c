// The part of CUDA's headers that kernels need, so that clang compiles them for a device without NVIDIA's. The build
// includes it before everything else (-include).
#pragma once
// In system headers only, functions of the device may overload constexpr functions of the standard library.
#pragma GCC system_header

#define __CUDACC__ 1
#define CUDA_VERSION 13000  // glm asks for it
#define __host__ __attribute__((host))
#define __device__ __attribute__((device))
#define __global__ __attribute__((global))
#define __constant__ __attribute__((constant))
#define __shared__ __attribute__((shared))
#define __forceinline__ inline __attribute__((always_inline))
#define __launch_bounds__(...) __attribute__((launch_bounds(__VA_ARGS__)))

// Overloads of functions that the standard library takes from the C library, before its headers declare them.
static __device__ __forceinline__ double floor(double x) { return __builtin_floor(x); }
static __device__ __forceinline__ long long llrint(double x) { return __nvvm_d2ll_rn(x); }
static __device__ __forceinline__ void* memcpy(void* to, const void* from, __SIZE_TYPE__ bytes) {
  return __builtin_memcpy(to, from, bytes);
}

#include <cstdlib>

struct uint3 {
  unsigned x, y, z;
};
struct dim3 {
  unsigned x, y, z;
};
#include <__clang_cuda_builtin_vars.h>

static __device__ __forceinline__ unsigned atomicAdd(unsigned* word, unsigned value) {
  return __atomic_fetch_add(word, value, __ATOMIC_RELAXED);
}
static __device__ __forceinline__ unsigned long long atomicAdd(unsigned long long* word, unsigned long long value) {
  return __atomic_fetch_add(word, value, __ATOMIC_RELAXED);
}
static __device__ __forceinline__ unsigned atomicMax(unsigned* word, unsigned value) {
  return __atomic_fetch_max(word, value, __ATOMIC_RELAXED);
}
static __device__ __forceinline__ unsigned long long atomicMax(unsigned long long* word, unsigned long long value) {
  return __atomic_fetch_max(word, value, __ATOMIC_RELAXED);
}
static __device__ __forceinline__ unsigned long long atomicMin(unsigned long long* word, unsigned long long value) {
  return __atomic_fetch_min(word, value, __ATOMIC_RELAXED);
}
static __device__ __forceinline__ unsigned long long atomicOr(unsigned long long* word, unsigned long long value) {
  return __atomic_fetch_or(word, value, __ATOMIC_RELAXED);
}
static __device__ __forceinline__ unsigned atomicCAS(unsigned* word, unsigned expected, unsigned desired) {
  __atomic_compare_exchange_n(word, &expected, desired, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED);
  return expected;
}
static __device__ __forceinline__ unsigned long long atomicCAS(unsigned long long* word, unsigned long long expected,
                                                               unsigned long long desired) {
  __atomic_compare_exchange_n(word, &expected, desired, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED);
  return expected;
}
