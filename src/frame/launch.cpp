#include "frame/launch.h"

#include <algorithm>
#include <atomic>
#include <optional>
#include <utility>

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#include "core/clock.h"
#include "core/parallel.h"
#include "frame/device_queue.h"

namespace relume {
struct ThreadLimit::State {
  explicit State(int threads)
      : count(threads > 0 ? threads : tbb::info::default_concurrency()),
        control(tbb::global_control::max_allowed_parallelism, static_cast<size_t>(count)) {}
  int count;
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads) : state_(std::make_unique<State>(threads)) {}
ThreadLimit::~ThreadLimit() = default;

int ThreadLimit::threads() const { return state_->count; }

struct Backend::State {
  explicit State(int threads) : count(threads > 0 ? threads : tbb::info::default_concurrency()) {
    // TBB uses as many threads as cores by default. The arena limits the threads of this backend only: another backend
    // in the process may have more or fewer.
    if (count > tbb::info::default_concurrency()) more_threads.emplace(count);
    arena.initialize(count);
  }
  int count;
  std::optional<ThreadLimit> more_threads;
  tbb::task_arena arena;
};

Backend::Backend(int threads, KernelForm form, Memory& memory, Denormals denormals)
    : state_(std::make_unique<State>(threads)), form_(form), denormals_(denormals), memory_(memory) {}
Backend::Backend(Device& device, int threads)
    : state_(std::make_unique<State>(threads)),
      form_(KernelForm::device),
      memory_(device.memory()),
      queue_(std::make_unique<DeviceQueue>(
          device, [this](std::string_view name, double seconds) { time_of(name).seconds += seconds; })) {}
Backend::~Backend() = default;

int Backend::threads() const { return state_->count; }

void Backend::configure(int threads, KernelForm form) {
  state_ = std::make_unique<State>(threads);
  if (!has_device()) form_ = form;
}

LaunchTime& Backend::time_of(std::string_view name) {
  const auto found = std::find_if(times_.begin(), times_.end(), [&](const LaunchTime& t) { return t.name == name; });
  return found != times_.end() ? *found : times_.emplace_back(LaunchTime{.name = std::string(name)});
}

void Backend::wait_for_device() {
  if (queue_) queue_->finish();
}

void Backend::execute(const std::function<void()>& function) {
  wait_for_device();
  state_->arena.execute([&] {
    const DenormalMode mode(denormals_);
    function();
  });
}

/// Reports begin and end of the outermost launch to the hook, and adds up the times of nested launches.
class Backend::LaunchScope {
 public:
  LaunchScope(Backend& backend, std::string_view name, const LaunchTiles& grid = {})
      : backend_(backend), name_(name), siblings_(std::exchange(backend.nested_, {})) {
    if (backend_.launch_depth_ == 0) report(LaunchEvent::Kind::begins, grid);
    ++backend_.launch_depth_;
  }
  ~LaunchScope() {
    const NestedTimes& own = total_.seconds > 0 ? total_ : backend_.nested_;  // only the nested ones after an exception
    backend_.nested_ = {siblings_.seconds + own.seconds, siblings_.idle_s + own.idle_s};
    if (--backend_.launch_depth_ == 0) report(LaunchEvent::Kind::ends);
  }
  LaunchScope(const LaunchScope&) = delete;
  LaunchScope& operator=(const LaunchScope&) = delete;

  /// Ends a launch that took `total`. Returns its times without those of nested launches.
  NestedTimes end(const NestedTimes& total) {
    total_ = total;
    return {total.seconds - backend_.nested_.seconds, total.idle_s - backend_.nested_.idle_s};
  }

 private:
  void report(LaunchEvent::Kind kind, const LaunchTiles& grid = {}) const {
    if (backend_.launch_hook_) backend_.launch_hook_({.kind = kind, .name = name_, .grid = grid});
  }

  Backend& backend_;
  std::string_view name_;
  NestedTimes siblings_;  ///< times of earlier launches in the same launch
  NestedTimes total_;     ///< 0 until the launch has ended
};

template <typename Function>
void Backend::timed(std::string_view name, const Function& function, const LaunchTiles& grid, bool own_threads) {
  wait_for_device();
  LaunchScope scope(*this, name, grid);
  const double start_s = now_s();
  LoopTimes loops;  // of the thread that runs `function`
  state_->arena.execute([&] {
    const LoopTimes before = loop_times();
    function();
    loops = {loop_times().elapsed_s - before.elapsed_s, loop_times().busy_s - before.busy_s};
  });
  const double seconds = now_s() - start_s;
  const double busy_s = loops.busy_s + (seconds - loops.elapsed_s);  // one thread works outside of loops
  LaunchTime& entry = time_of(name);
  const NestedTimes own = scope.end({seconds, threads() * seconds - busy_s});
  entry.seconds += own.seconds;
  if (!own_threads) entry.idle_s += std::max(0.0, own.idle_s);
  ++entry.launches;
}

bool Backend::launch_on_device(const DeviceLaunch& launch, const std::stop_token& stop) {
  LaunchScope scope(*this, launch.name);
  const bool is_nested = launch_depth_ > 1;
  const double start_s = now_s();
  const bool is_empty = launch.window.width() == 0 || launch.window.height() == 0;
  const bool complete = is_empty || queue_->launch(launch, stop, tile_hook_);
  if (is_nested) queue_->finish();  // the enclosing host code may read the results
  ++time_of(launch.name).launches;
  // Device time counts neither as work nor as idle time of the enclosing host code.
  const double seconds = now_s() - start_s;
  scope.end({seconds, (threads() - 1) * seconds});
  return complete;
}

bool Backend::for_each_tile(std::string_view name, uint32_t width, uint32_t height,
                            void (*run_tile)(const void*, const Tile&), const void* context,
                            const std::stop_token& stop, uint32_t tile_size) {
  const LaunchTiles grid{width, height, tile_size};
  std::atomic<bool> complete{true};
  const auto run = [&] {
    parallel_tasks(grid.tiles(), [&](uint32_t index) {
      if (tile_hook_) tile_hook_();
      if (stop.stop_requested()) {
        complete.store(false, std::memory_order_relaxed);
        return;
      }
      const DenormalMode mode(denormals_);
      run_tile(context, grid.tile(index));
    });
  };
  timed(name, run, grid);
  return complete.load();
}

void Backend::run(std::string_view name, const std::function<void()>& function) {
  timed(name, [&] {
    const DenormalMode mode(denormals_);
    function();
  });
}

void Backend::run_library(std::string_view name, const std::function<void()>& function) {
  timed(name, function, {}, true);
}

}  // namespace relume
