#include "runtime/block.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstring>
#include <new>
#include <numeric>

namespace ptx {
namespace {

constexpr size_t kStackBytes = size_t{1} << 20;

thread_local Block* current_block = nullptr;

/// Ends a thread from within functions that it calls.
struct ThreadExit {};

}  // namespace

uint32_t Random::below(uint32_t end) {
  state_ += 0x9e3779b97f4a7c15u;
  uint64_t x = state_;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return static_cast<uint32_t>((x ^ (x >> 31)) % end);
}

std::vector<uint32_t> shuffled_indices(uint32_t count, Random& random) {
  std::vector<uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  for (uint32_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return order;
}

Stack::Stack() : begin_(mmap(nullptr, kStackBytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)) {
  if (begin_ == MAP_FAILED) throw std::bad_alloc();
  mprotect(begin_, static_cast<size_t>(sysconf(_SC_PAGESIZE)), PROT_NONE);
}

Stack::~Stack() { munmap(begin_, kStackBytes); }

size_t Stack::bytes() const { return kStackBytes; }

Block::Block(const Module& module, const Entry& entry, const Launch& launch, void* const* parameters, const Dim& index)
    : entry_(entry),
      parameters_(parameters),
      special_{{0, 0, 0}, launch.block, index, launch.grid},
      thread_count_(launch.block.x * launch.block.y * launch.block.z),
      dynamic_begin_((module.shared_bytes + sizeof(SharedLine) - 1) / sizeof(SharedLine) * sizeof(SharedLine)),
      random_(launch.seed ^ (uint64_t{index.x} << 40 ^ uint64_t{index.y} << 20 ^ index.z)) {
  if (current_block) throw Fault("a kernel launches another");
  const size_t bytes = entry.shares ? dynamic_begin_ + launch.dynamic_shared_bytes : 0;
  const size_t lines = bytes / sizeof(SharedLine) + 1;
  shared_ = std::make_unique_for_overwrite<SharedLine[]>(lines);
  std::memset(shared_.get(), 0xff, lines * sizeof(SharedLine));
  current_block = this;
}

Block::~Block() { current_block = nullptr; }

Block& Block::current() {
  if (!current_block) throw Fault("no kernel runs on this thread");
  return *current_block;
}

void Block::run() {
  if (entry_.cooperative) {
    run_fibers();
  } else {
    run_in_order();
  }
}

void Block::select(uint32_t thread) {
  thread_ = thread;
  const Dim& n = special_.ntid;
  special_.tid = {thread % n.x, thread / n.x % n.y, thread / n.x / n.y};
}

void Block::run_thread() const {
  try {
    entry_.run(reinterpret_cast<unsigned char* const*>(parameters_));
  } catch (const ThreadExit&) {
  }
}

void Block::run_in_order() {
  for (const uint32_t thread : shuffled_indices(thread_count_, random_)) {
    select(thread);
    run_thread();
  }
}

// ---- Fibers

void Block::start() {
  Block& block = current();
  try {
    block.run_thread();
  } catch (...) {
    block.failure_ = std::current_exception();
  }
  block.fibers_[block.thread_].ended = true;
}

void Block::run_fibers() {
  fibers_ = std::vector<Fiber>(thread_count_);
  for (Fiber& fiber : fibers_) {
    fiber.stack = std::make_unique<Stack>();
    getcontext(&fiber.context);
    fiber.context.uc_stack.ss_sp = fiber.stack->begin();
    fiber.context.uc_stack.ss_size = fiber.stack->bytes();
    fiber.context.uc_link = &scheduler_;
    makecontext(&fiber.context, &Block::start, 0);
  }
  do {
    for (const uint32_t thread : shuffled_indices(thread_count_, random_)) {
      if (!fibers_[thread].ended && fibers_[thread].wait.kind == Wait::Kind::nothing) resume(thread);
    }
  } while (release_waiting());
}

void Block::resume(uint32_t thread) {
  select(thread);
  swapcontext(&scheduler_, &fibers_[thread].context);
  if (failure_) std::rethrow_exception(failure_);
}

void Block::wait(const Wait& wait) {
  Fiber& fiber = fibers_[thread_];
  fiber.wait = wait;
  swapcontext(&fiber.context, &scheduler_);
}

Block::Arrivals Block::arrivals() const {
  Arrivals found;
  for (const Fiber& fiber : fibers_) {
    found.alive += fiber.ended ? 0 : 1;
    if (!fiber.ended && fiber.wait.kind == Wait::Kind::barrier) ++found.at[fiber.wait.barrier];
  }
  return found;
}

bool Block::may_continue(uint32_t thread, const Arrivals& arrivals) const {
  const Wait& wait = fibers_[thread].wait;
  if (wait.kind == Wait::Kind::barrier) {
    const uint32_t arrived = arrivals.at[wait.barrier];
    return arrived == arrivals.alive || (wait.count != 0 && arrived >= wait.count);
  }
  const uint32_t first = thread / kWarpSize * kWarpSize;
  for (uint32_t lane = 0; lane < kWarpSize && first + lane < thread_count_; ++lane) {
    const Wait& other = fibers_[first + lane].wait;
    const bool member = ((wait.members >> lane) & 1u) != 0;
    if (member && (other.kind != Wait::Kind::warp || other.members != wait.members)) return false;
  }
  return true;
}

/// Lets threads continue that have waited long enough. Returns whether any is left. Throws Fault if none can continue.
bool Block::release_waiting() {
  const Arrivals arrived = arrivals();
  std::vector<uint32_t> released;
  for (uint32_t thread = 0; thread < thread_count_; ++thread) {
    if (!fibers_[thread].ended && may_continue(thread, arrived)) released.push_back(thread);
  }
  if (arrived.alive > 0 && released.empty()) fail_deadlock();
  for (const uint32_t thread : released) fibers_[thread].wait = {};
  return arrived.alive > 0;
}

void Block::fail_deadlock() const {
  uint32_t waiting = 0;
  for (const Fiber& fiber : fibers_) waiting += fiber.ended ? 0 : 1;
  const Dim& at = special_.ctaid;
  throw Fault(entry_.name + ": in block (" + std::to_string(at.x) + ", " + std::to_string(at.y) + ", " +
              std::to_string(at.z) + "), " + std::to_string(waiting) + " of " + std::to_string(thread_count_) +
              " threads wait for others that never come");
}

std::vector<uint32_t> Block::exchange(uint32_t value, uint32_t members) {
  if (((members >> laneid()) & 1u) == 0) throw Fault(entry_.name + ": a thread is not among the members that it names");
  fibers_[thread_].published = value;
  wait({Wait::Kind::warp, 0, 0, members});
  std::vector<uint32_t> values(kWarpSize);
  const uint32_t first = thread_ / kWarpSize * kWarpSize;
  for (uint32_t i = 0; i < kWarpSize && first + i < thread_count_; ++i) values[i] = fibers_[first + i].published;
  wait({Wait::Kind::warp, 0, 0, members});
  return values;
}

void exit_thread() { throw ThreadExit{}; }

}  // namespace ptx
