// Launches pass kernels. A pass kernel is a trivially copyable struct of views and settings with
//
//   RELUME_HD void operator()(uint32_t x, uint32_t y) const;
//
// called once for each element of a grid. On the host, TBB distributes tiles of the grid over the threads. A device
// (frame/device.h) executes the compiled code of the same struct. A kernel may provide a second form for the host that
// processes a tile at once (for example in ray packets). It must compute the same bits as the one-element form, which a
// backend may run instead:
//
//   void operator()(const Tile& tile) const;
//
// Elements that need a group of threads are group kernels (frame/group.h).
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/array.h"
#include "core/denormals.h"
#include "core/hd.h"
#include "frame/device.h"
#include "frame/group.h"
#include "frame/kernel_names.h"
#include "frame/tile.h"

namespace relume {

class DeviceQueue;

template <typename K>
concept TileKernel = requires(const K& k, const Tile& tile) {
  k(tile);
};

/// Kernels with one thread per element.
template <typename K>
concept PassKernel = KernelArgument<K> && requires(const K& k, uint32_t x, uint32_t y) {
  { k(x, y) } -> std::same_as<void>;
};

/// Kernels that can be launched.
template <typename K>
concept LaunchableKernel = PassKernel<K> || GroupKernel<K>;

/// Total time of the launches with one name, without launches in them that have times of their own.
struct LaunchTime {
  std::string name;
  double seconds = 0;     ///< on the host or the device, whichever executed them
  double idle_s = 0;      ///< thread-seconds spent waiting for other threads of the host
  uint64_t launches = 0;  ///< launches that did not throw
};

/// Limits the threads of all parallel work during its lifetime: of backends, and of work beside them such as loading.
class ThreadLimit {
 public:
  /// `threads` 0: one per core.
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

  int threads() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A step of a launch, for Backend::on_launch().
struct LaunchEvent {
  enum class Kind : uint8_t {
    kernel,  ///< a kernel is about to be launched
    begins,  ///< a kernel, or host code that is timed like one, begins; on a device, it is about to be queued
    ends,    ///< the kernel or host code has ended or has thrown; on a device, the kernel may only be queued
  };
  Kind kind = Kind::begins;
  std::string_view name;
  std::span<const std::byte> argument = {};  ///< for Kind::kernel: a copy of the kernel with zeroed padding
  LaunchTiles grid = {};  ///< for Kind::begins of tiles on the host, each a task of a thread; else without tiles
};

/// Executes kernels and host code: a thread pool of the processor, with or without a device for the kernels, and the
/// memory that both access. With a device, host code waits for the queued launches: the functions below do, and
/// Array::read() and write().
class Backend {
 public:
  /// Kernels run on the threads. `threads` 0: one per core. `memory` must outlive the backend. `denormals`: of kernels
  /// and host code; kept for the bits of devices, flushed for Embree.
  explicit Backend(int threads = 0, KernelForm form = KernelForm::host, Memory& memory = host_memory(),
                   Denormals denormals = Denormals::keep);
  /// Kernels run on `device`, which must outlive the backend, and host code on the threads. Both keep denormals.
  explicit Backend(Device& device, int threads = 0);
  ~Backend();
  Backend(const Backend&) = delete;
  Backend& operator=(const Backend&) = delete;

  int threads() const;
  KernelForm form() const { return form_; }
  /// Changes the threads, and the form of kernels that the host executes. Keeps hooks and times. Call between launches.
  void configure(int threads, KernelForm form);
  /// Source of the memory that kernels access.
  Memory& memory() const { return memory_; }
  /// Whether a device executes the kernels.
  bool has_device() const { return queue_ != nullptr; }
  /// Without those of launches that the device has not executed yet.
  const std::vector<LaunchTime>& times() const { return times_; }

  /// Device: queues a launch. Returns false if `stop` was requested before all of it was queued. Throws as
  /// Device::launch().
  bool launch_on_device(const DeviceLaunch& launch, const std::stop_token& stop);

  /// Calls run_tile(context, tile) for every tile. Returns false if `stop` was requested before all were done.
  bool for_each_tile(std::string_view name, uint32_t width, uint32_t height,
                     void (*run_tile)(const void* context, const Tile& tile), const void* context,
                     const std::stop_token& stop, uint32_t tile_size = kTileSize);

  /// Calls `hook` before each tile, on the thread that runs the tile; with a device, before each band of a launch.
  /// Tests use it to stop frames at any tile. Empty: no hook.
  void on_tile(std::function<void()> hook) { tile_hook_ = std::move(hook); }

  /// Calls `hook` at each step of each launch, on the launching thread. Nested launches belong to the outermost. Tests
  /// use it to protect memory between launches. Empty: no hook.
  void on_launch(std::function<void(const LaunchEvent&)> hook) { launch_hook_ = std::move(hook); }
  bool watches_launches() const { return launch_hook_ != nullptr; }
  /// Reports a kernel to the hook.
  void report(const LaunchEvent& event) const { launch_hook_(event); }

  /// Runs host code; its parallel loops use the backend's threads.
  void execute(const std::function<void()>& function);

  /// The same, timed like a launch, for preparing passes without a grid.
  void run(std::string_view name, const std::function<void()>& function);
  /// The same for libraries with threads of their own. Their idle time is unknown and counts as 0.
  void run_library(std::string_view name, const std::function<void()>& function);

 private:
  /// Runs `function` in the arena and adds its times. `grid`: of the tiles that it runs. `own_threads`: it runs on
  /// threads of a library, not on the backend's.
  template <typename Function>
  void timed(std::string_view name, const Function& function, const LaunchTiles& grid = {}, bool own_threads = false);

  /// Times of launches within one launch.
  struct NestedTimes {
    double seconds = 0;
    double idle_s = 0;
  };
  class LaunchScope;
  struct State;
  /// The times of the launches called `name`.
  LaunchTime& time_of(std::string_view name);
  void wait_for_device();

  std::unique_ptr<State> state_;
  KernelForm form_;
  Denormals denormals_ = Denormals::keep;
  Memory& memory_;
  std::unique_ptr<DeviceQueue> queue_;  ///< nullptr without a device
  std::vector<LaunchTime> times_;
  std::function<void()> tile_hook_;
  std::function<void(const LaunchEvent&)> launch_hook_;
  int launch_depth_ = 0;  ///< depth of nested launches
  NestedTimes nested_;    ///< of the launches that ended in the current one
};

/// Host: calls `work(tile)` for the tiles of `window`, on all threads of `backend`. Returns false if `stop` was
/// requested first; some tiles are then missing. `tile_size`: edge of a tile, elements; small for expensive elements.
template <typename Work>
bool launch_tiles(Backend& backend, std::string_view name, const Work& work, const Tile& window,
                  const std::stop_token& stop, uint32_t tile_size = kTileSize) {
  struct Task {
    const Work& work;
    const Tile& window;
  };
  const auto run = [](const void* context, const Tile& part) {
    const auto& [on_tile, all] = *static_cast<const Task*>(context);
    on_tile(Tile{all.x0 + part.x0, all.y0 + part.y0, all.x0 + part.x1, all.y0 + part.y1});
  };
  const Task task{work, window};
  return backend.for_each_tile(name, window.x1 - window.x0, window.y1 - window.y0, run, &task, stop, tile_size);
}

/// Calls use(bytes) with a copy of `kernel` with zeroed padding: equal kernels then have equal bytes. Long
/// arrays of structures must be the last members of a kernel: GCC 12 misplaces the padding behind eight elements,
/// though not behind two.
template <LaunchableKernel K, typename Use>
void with_argument(const K& kernel, const Use& use) {
  K argument = kernel;
#if __has_builtin(__builtin_clear_padding)
  __builtin_clear_padding(&argument);
#endif
  use(std::as_bytes(std::span(&argument, 1)));
}

/// Reports a kernel to the backend's hook.
template <LaunchableKernel K>
[[gnu::cold, gnu::noinline]] void report_kernel(const Backend& backend, std::string_view name, const K& kernel) {
  with_argument(kernel, [&](std::span<const std::byte> argument) {
    backend.report({LaunchEvent::Kind::kernel, name, argument});
  });
}

/// launch() for backends with a device.
template <LaunchableKernel K>
[[gnu::cold, gnu::noinline]] bool launch_on_device(Backend& backend, std::string_view name, const K& kernel,
                                                   const Tile& window, const std::stop_token& stop) {
  uint32_t threads = 0;
  if constexpr (GroupKernel<K>) threads = K::kThreads;
  bool complete = false;
  with_argument(kernel, [&](std::span<const std::byte> argument) {
    complete = backend.launch_on_device({name, kernel_type_name<K>(), threads, argument, window}, stop);
  });
  return complete;
}

/// Runs `kernel` over the elements of `window`. Returns false if `stop` was requested first; some elements are then
/// missing. `tile_size`: as for launch_tiles(); a device ignores it.
template <LaunchableKernel K>
bool launch(Backend& backend, std::string_view name, const K& kernel, const Tile& window,
            const std::stop_token& stop = {}, uint32_t tile_size = kTileSize) {
  if (backend.watches_launches()) report_kernel(backend, name, kernel);
  if (backend.has_device()) return launch_on_device(backend, name, kernel, window, stop);
  const auto run = [&](const Tile& tile) {
    if constexpr (TileKernel<K>) {
      if (backend.form() == KernelForm::host) return kernel(tile);
    }
    for (uint32_t y = tile.y0; y < tile.y1; ++y) {
      for (uint32_t x = tile.x0; x < tile.x1; ++x) {
        if constexpr (GroupKernel<K>) {
          run_group(kernel, x, y, backend.form());
        } else {
          kernel(x, y);
        }
      }
    }
  };
  return launch_tiles(backend, name, run, window, stop, tile_size);
}

/// Runs `kernel` over a width × height grid.
template <LaunchableKernel K>
bool launch(Backend& backend, std::string_view name, const K& kernel, uint32_t width, uint32_t height,
            const std::stop_token& stop = {}, uint32_t tile_size = kTileSize) {
  return launch(backend, name, kernel, Tile{0, 0, width, height}, stop, tile_size);
}

}  // namespace relume
