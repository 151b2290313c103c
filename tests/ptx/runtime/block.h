// A block of threads while it runs.
#pragma once

#include <ucontext.h>

#include <array>
#include <cstdint>
#include <exception>
#include <memory>
#include <vector>

#include "instructions/thread.h"
#include "runtime/launch.h"

namespace ptx {

/// Random numbers for orders (SplitMix64).
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}
  uint32_t below(uint32_t end);

 private:
  uint64_t state_;
};

/// 0 … count − 1 in random order.
std::vector<uint32_t> shuffled_indices(uint32_t count, Random& random);

/// Stack of a fiber, with an inaccessible page at its end.
class Stack {
 public:
  Stack();
  ~Stack();
  Stack(const Stack&) = delete;
  Stack& operator=(const Stack&) = delete;

  void* begin() const { return begin_; }
  size_t bytes() const;

 private:
  void* begin_;
};

/// Barriers of a block.
inline constexpr uint32_t kBarriers = 16;

/// What a thread waits for.
struct Wait {
  enum class Kind : uint8_t { nothing, barrier, warp };
  Kind kind = Kind::nothing;
  uint32_t barrier = 0;  ///< number of the barrier
  uint32_t count = 0;    ///< threads that it waits for; 0: all that have not ended
  uint32_t members = 0;  ///< threads of the warp
};

/// Threads of one block. One block at a time runs on a thread of the processor.
class Block {
 public:
  Block(const Module& module, const Entry& entry, const Launch& launch, void* const* parameters, const Dim& index);
  ~Block();
  Block(const Block&) = delete;
  Block& operator=(const Block&) = delete;

  /// The block that runs on this thread. Throws Fault if there is none.
  static Block& current();

  void run();

  const Special& special() const { return special_; }
  uint32_t thread() const { return thread_; }
  unsigned char* shared() const { return shared_[0].bytes; }
  unsigned char* dynamic_shared() const { return shared() + dynamic_begin_; }

  /// Suspends the current thread until the others have come as far.
  void wait(const Wait& wait);
  /// Publishes a value of the current thread; returns those of its warp, by lane, once all members have published.
  std::vector<uint32_t> exchange(uint32_t value, uint32_t members);

 private:
  struct Fiber {
    std::unique_ptr<Stack> stack;
    ucontext_t context;
    Wait wait;
    bool ended = false;
    uint32_t published = 0;
  };

  /// Threads that have not ended, and those that wait at each barrier.
  struct Arrivals {
    uint32_t alive = 0;
    std::array<uint32_t, kBarriers> at{};
  };

  /// As aligned as a device aligns the beginning of shared memory.
  struct alignas(128) SharedLine {
    unsigned char bytes[128];
  };

  static void start();
  void select(uint32_t thread);
  void run_in_order();
  void run_fibers();
  void resume(uint32_t thread);
  void run_thread() const;
  Arrivals arrivals() const;
  bool may_continue(uint32_t thread, const Arrivals& arrivals) const;
  bool release_waiting();
  [[noreturn]] void fail_deadlock() const;

  const Entry& entry_;
  void* const* parameters_;
  Special special_;
  uint32_t thread_ = 0;
  uint32_t thread_count_;
  size_t dynamic_begin_;
  std::unique_ptr<SharedLine[]> shared_;
  Random random_;
  std::vector<Fiber> fibers_;
  ucontext_t scheduler_;
  std::exception_ptr failure_;
};

}  // namespace ptx
