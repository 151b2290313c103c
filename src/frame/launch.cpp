#include "frame/launch.h"

#include <algorithm>
#include <atomic>
#include <optional>

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/task_arena.h>

#if defined(__SSE__)
#include <pmmintrin.h>
#include <xmmintrin.h>
#endif

#include "core/clock.h"
#include "core/parallel.h"

namespace relume {
namespace {

// The processor's floating-point control register, and its bits that flush denormal operands and results.
#if defined(__SSE__)
uint64_t float_control() { return _mm_getcsr(); }
void set_float_control(uint64_t value) { _mm_setcsr(static_cast<unsigned>(value)); }
constexpr uint64_t kFlushDenormals = _MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON;
#elif defined(__aarch64__)
uint64_t float_control() { return __builtin_aarch64_get_fpcr64(); }
void set_float_control(uint64_t value) { __builtin_aarch64_set_fpcr64(value); }
constexpr uint64_t kFlushDenormals = uint64_t{1} << 24;  // FZ
#else
uint64_t float_control() { return 0; }
void set_float_control(uint64_t) {}
constexpr uint64_t kFlushDenormals = 0;
#endif

/// Flushes denormals to zero, which Embree requires in every thread that traces. Restores the caller's mode.
class FlushDenormals {
 public:
  FlushDenormals() : saved_(float_control()) { set_float_control(saved_ | kFlushDenormals); }
  ~FlushDenormals() { set_float_control(saved_); }
  FlushDenormals(const FlushDenormals&) = delete;
  FlushDenormals& operator=(const FlushDenormals&) = delete;

 private:
  uint64_t saved_;
};

}  // namespace

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

Backend::Backend(int threads, KernelForm form, Memory& memory)
    : state_(std::make_unique<State>(threads)), form_(form), memory_(memory) {}
Backend::~Backend() = default;

int Backend::threads() const { return state_->count; }

void Backend::execute(const std::function<void()>& function) { state_->arena.execute(function); }

/// Reports begin and end of the outermost launch to the hook.
class Backend::LaunchScope {
 public:
  LaunchScope(Backend& backend, std::string_view name) : backend_(backend), name_(name) {
    if (backend_.launch_depth_ == 0) report(LaunchEvent::Kind::begins);
    ++backend_.launch_depth_;
  }
  ~LaunchScope() {
    if (--backend_.launch_depth_ == 0) report(LaunchEvent::Kind::ends);
  }
  LaunchScope(const LaunchScope&) = delete;
  LaunchScope& operator=(const LaunchScope&) = delete;

 private:
  void report(LaunchEvent::Kind kind) const {
    if (backend_.launch_hook_) backend_.launch_hook_({kind, name_});
  }

  Backend& backend_;
  std::string_view name_;
};

template <typename Function>
void Backend::timed(std::string_view name, const Function& function, bool own_threads) {
  const LaunchScope scope(*this, name);
  const double start_s = now_s();
  LoopTimes loops;  // of the thread that runs `function`
  state_->arena.execute([&] {
    const LoopTimes before = loop_times();
    function();
    loops = {loop_times().elapsed_s - before.elapsed_s, loop_times().busy_s - before.busy_s};
  });
  const double seconds = now_s() - start_s;
  const double busy_s = loops.busy_s + (seconds - loops.elapsed_s);  // one thread works outside of loops
  const auto found = std::find_if(times_.begin(), times_.end(), [&](const LaunchTime& t) { return t.name == name; });
  LaunchTime& entry = found != times_.end() ? *found : times_.emplace_back(LaunchTime{.name = std::string(name)});
  entry.seconds += seconds;
  if (!own_threads) entry.idle_s += std::max(0.0, threads() * seconds - busy_s);
  ++entry.launches;
}

bool Backend::for_each_tile(std::string_view name, uint32_t width, uint32_t height,
                            void (*run_tile)(const void*, const Tile&), const void* context,
                            const std::stop_token& stop, uint32_t tile_size) {
  const uint32_t columns = width / tile_size + (width % tile_size > 0 ? 1 : 0);
  const uint32_t rows = height / tile_size + (height % tile_size > 0 ? 1 : 0);
  std::atomic<bool> complete{true};
  timed(name, [&] {
    parallel_tasks(columns * rows, [&](uint32_t index) {
      if (tile_hook_) tile_hook_();
      if (stop.stop_requested()) {
        complete.store(false, std::memory_order_relaxed);
        return;
      }
      const FlushDenormals guard;
      const uint32_t x = index % columns * tile_size;
      const uint32_t y = index / columns * tile_size;
      run_tile(context, {x, y, x + std::min(tile_size, width - x), y + std::min(tile_size, height - y)});
    });
  });
  return complete.load();
}

void Backend::run(std::string_view name, const std::function<void()>& function) {
  timed(name, [&] {
    const FlushDenormals guard;
    function();
  });
}

void Backend::run_library(std::string_view name, const std::function<void()>& function) { timed(name, function, true); }

}  // namespace relume
