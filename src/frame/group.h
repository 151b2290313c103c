// Group kernels: each element is the work of a group of threads (a thread block in CUDA) with shared memory and
// barriers. A group kernel is plain data, like a pass kernel, with
//
//   static constexpr uint32_t kThreads = 128;  // threads of a group on a device
//   struct Shared { … };                       // memory of the group, uninitialised: plain data of at most 48 KiB
//   template <typename Group>
//   RELUME_HD void operator()(const Group& group, Shared& shared, uint32_t x, uint32_t y) const;
//
// called once for each element of a grid. group.each(n, f) calls f(i) for every i < n. Its rules:
//
// - The calls of one each() are independent. They may use common atomic counters and sets if the result does not depend
//   on the order.
// - Every thread executes the code outside of each(). It writes local variables only. All threads must reach the same
//   calls of each(), because each() has barriers.
//
// On the host, one thread executes a group. A kernel may provide a faster form of one element for the host, which must
// compute the same bits:
//
//   void on_host(uint32_t x, uint32_t y) const;
#pragma once

#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "core/hd.h"

namespace relume {

/// Memory that the threads of a group can share on every device, bytes.
inline constexpr size_t kMaxSharedBytes = size_t{48} * 1024;

/// The threads that execute one element of a group kernel: a block on a device, one thread on the host.
template <uint32_t threads>
struct ThreadGroup {
  /// Calls f(i) for every i < n, distributed over the threads, with a barrier before and after. Calls therefore see all
  /// earlier writes, and never overwrite values that another thread still reads outside of each().
  template <typename Function>
  RELUME_HD_INLINE void each(uint32_t n, const Function& f) const {
#if RELUME_DEVICE_CODE
    __syncthreads();
    for (uint32_t i = threadIdx.x; i < n; i += threads) f(i);
    __syncthreads();
#else
    for (uint32_t i = 0; i < n; ++i) f(i);
#endif
  }
};

/// Plain data of at most 4 KiB, the limit of a kernel argument.
template <typename K>
concept KernelArgument = std::is_trivially_copyable_v<K> && std::is_standard_layout_v<K> && sizeof(K) <= 4096;

/// Group kernels that can be launched.
template <typename K>
concept GroupKernel = KernelArgument<K> && K::kThreads >= 1 && K::kThreads <= 1024 &&
                      std::is_trivial_v<typename K::Shared> &&
                      sizeof(typename K::Shared) <= kMaxSharedBytes&& requires(const K& kernel,
                                                                               const ThreadGroup<K::kThreads>& group,
                                                                               typename K::Shared& shared, uint32_t x) {
  { kernel(group, shared, x, x) } -> std::same_as<void>;
};

/// Group kernels with a form for the host.
template <typename K>
concept HostFormKernel = GroupKernel<K> && requires(const K& kernel, uint32_t x) {
  { kernel.on_host(x, x) } -> std::same_as<void>;
};

/// The form of kernels that a backend runs, where they have two. Both give the same bits.
enum class KernelForm : uint8_t {
  host,    ///< several elements in vector registers or ray packets, or on_host()
  device,  ///< one element, or one group, per call
};

/// Executes one element of a group kernel on the calling thread, in the form `form` if the kernel has two.
template <GroupKernel K>
void run_group(const K& kernel, uint32_t x, uint32_t y, [[maybe_unused]] KernelForm form) {
  if constexpr (HostFormKernel<K>) {
    if (form == KernelForm::host) return kernel.on_host(x, y);
  }
  typename K::Shared shared;
  kernel(ThreadGroup<K::kThreads>{}, shared, x, y);
}

}  // namespace relume
