#include "testing/walled_memory.h"

#include <execinfo.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>
#include <utility>

namespace relume::testing {
namespace {

std::atomic<WalledMemory*> g_memory = nullptr;

size_t page_bytes() {
  static const auto bytes = static_cast<size_t>(::sysconf(_SC_PAGESIZE));
  return bytes;
}

bool is_mapped(uint64_t address) {
  unsigned char resident = 0;
  void* const page = reinterpret_cast<void*>(address & ~(page_bytes() - 1));  // NOLINT(performance-no-int-to-ptr)
  return ::mincore(page, 1, &resident) == 0 || errno != ENOMEM;
}

/// Calls f(address, byte) for each aligned word of `data` that is the address of a mapped page.
template <typename F>
void for_each_address(std::span<const std::byte> data, const F& f) {
  for (size_t at = 0; at + sizeof(uint64_t) <= data.size(); at += sizeof(uint64_t)) {
    uint64_t word = 0;
    std::memcpy(&word, data.data() + at, sizeof(word));
    const bool may_be_address = word >> 32 != 0 && word >> 47 == 0;
    if (may_be_address && is_mapped(word)) f(reinterpret_cast<const std::byte*>(word), at);  // NOLINT
  }
}

/// Prints the calls that led to a violation.
void print_calls() {
  void* calls[32];
  ::backtrace_symbols_fd(calls, ::backtrace(calls, 32), STDERR_FILENO);
}

}  // namespace

WalledMemory::WalledMemory() {
  WalledMemory* none = nullptr;
  if (!g_memory.compare_exchange_strong(none, this)) {
    std::fputs("WalledMemory: two exist at a time\n", stderr);
    std::abort();
  }
  struct sigaction action {};
  action.sa_sigaction = on_fault;
  action.sa_flags = SA_SIGINFO | SA_NODEFER;
  sigemptyset(&action.sa_mask);
  ::sigaction(SIGSEGV, &action, &previous_action_);
}

WalledMemory::~WalledMemory() {
  ::sigaction(SIGSEGV, &previous_action_, nullptr);
  g_memory = nullptr;
  for (const Blocks::value_type& block : blocks_) ::munmap(block.first, block.second.mapped);
}

void* WalledMemory::allocate(size_t bytes, size_t alignment) {
  if (alignment > page_bytes()) throw std::bad_alloc();
  const size_t pages = (bytes + page_bytes() - 1) / page_bytes();
  const size_t mapped = (pages + 1) * page_bytes();  // the last page stays closed
  void* const memory = ::mmap(nullptr, mapped, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::bad_alloc();
  // Elements that are read before they are written change the image.
  ::mprotect(memory, pages * page_bytes(), PROT_READ | PROT_WRITE);
  std::memset(memory, 0xa5, pages * page_bytes());
  if (pages > 0) ::mprotect(memory, pages * page_bytes(), PROT_NONE);
  const std::lock_guard lock(mutex_);
  const auto added = blocks_.emplace(static_cast<std::byte*>(memory), Block{bytes, mapped, Access::none}).first;
  if (launches_ > 0 && !in_host_work_) {
    added->second.access = Access::write;
    protect(*added, Access::write);
  }
  return memory;
}

void WalledMemory::deallocate(void* block, size_t, size_t) noexcept {
  const std::lock_guard lock(mutex_);
  const auto found = blocks_.find(static_cast<std::byte*>(block));
  if (found == blocks_.end()) return;
  ::munmap(found->first, found->second.mapped);
  blocks_.erase(found);
}

void WalledMemory::protect(const Blocks::value_type& block, Access access) {
  const int flags = access == Access::write ? PROT_READ | PROT_WRITE : access == Access::read ? PROT_READ : PROT_NONE;
  if (block.second.mapped > page_bytes()) ::mprotect(block.first, block.second.mapped - page_bytes(), flags);
}

WalledMemory::Blocks::iterator WalledMemory::find(const std::byte* address) {
  auto after = blocks_.upper_bound(const_cast<std::byte*>(address));
  if (after == blocks_.begin()) return blocks_.end();
  --after;
  return address < after->first + after->second.mapped ? after : blocks_.end();
}

void WalledMemory::open(const std::byte* address, Access access) {
  const std::lock_guard lock(mutex_);
  const auto block = find(address);
  if (block == blocks_.end()) return;
  if (launches_ == 0 && block->second.bytes > host_limit_ && !unlimited_.contains(block->second.bytes)) {
    violations_.push_back("host code opened a block of " + std::to_string(block->second.bytes) +
                          " bytes after the launch of '" + last_launch_ + "'; process it in a launch");
    print_calls();
  }
  if (in_host_work_) count(block->second);
  if (block->second.access >= access) return;
  block->second.access = access;
  protect(*block, access);
}

void WalledMemory::open_for_reading(const void* block) { open(static_cast<const std::byte*>(block), Access::read); }
void WalledMemory::open_for_writing(void* block) { open(static_cast<const std::byte*>(block), Access::write); }

void WalledMemory::begin_work(const void* address) {
  const auto block = find(static_cast<const std::byte*>(address));
  if (block != blocks_.end()) protect(*block, Access::write);
}

void WalledMemory::end_work(const void* address) {
  const auto block = find(static_cast<const std::byte*>(address));
  if (block == blocks_.end() || (launches_ > 0 && !in_host_work_)) return;
  block->second.access = Access::none;
  protect(*block, Access::none);
}

void WalledMemory::copy(void* to, const void* from, size_t bytes) {
  const std::lock_guard lock(mutex_);
  begin_work(from);
  begin_work(to);
  std::memcpy(to, from, bytes);
  end_work(from);
  end_work(to);
}

void WalledMemory::zero(void* to, size_t bytes) {
  const std::lock_guard lock(mutex_);
  begin_work(to);
  std::memset(to, 0, bytes);
  end_work(to);
}

void WalledMemory::open_all() {
  for (Blocks::value_type& block : blocks_) {
    if (block.second.access != Access::write) protect(block, Access::write);
    block.second.access = Access::write;
  }
}

void WalledMemory::close_all() {
  for (Blocks::value_type& block : blocks_) {
    protect(block, Access::none);
    block.second.access = Access::none;
    block.second.counted = false;
  }
}

void WalledMemory::begin_launch(std::string_view name) {
  const std::lock_guard lock(mutex_);
  ++launches_;
  last_launch_ = name;
  in_host_work_ = counts_host_work_ && !has_kernel_;
  if (in_host_work_) {
    close_all();
  } else {
    open_all();
  }
}

void WalledMemory::end_launch() {
  const std::lock_guard lock(mutex_);
  if (--launches_ > 0) return;
  if (work_bytes_ > 0) {
    size_t& most = host_work_[last_launch_];
    most = std::max(most, work_bytes_);
  }
  work_bytes_ = 0;
  in_host_work_ = has_kernel_ = false;
  close_all();
}

void WalledMemory::announce_kernel() {
  const std::lock_guard lock(mutex_);
  has_kernel_ = true;
  if (!in_host_work_) return;
  in_host_work_ = false;
  open_all();
}

void WalledMemory::count(Block& block) {
  if (!block.counted) work_bytes_ += block.bytes;
  block.counted = true;
}

void WalledMemory::count_host_work() {
  const std::lock_guard lock(mutex_);
  counts_host_work_ = true;
}

std::map<std::string, size_t> WalledMemory::host_work() const {
  const std::lock_guard lock(mutex_);
  return host_work_;
}

void WalledMemory::limit_host_access(size_t bytes, std::set<size_t> except) {
  const std::lock_guard lock(mutex_);
  host_limit_ = bytes;
  unlimited_ = std::move(except);
}

void WalledMemory::permit(const void* handle) {
  const std::lock_guard lock(mutex_);
  if (handle) permitted_.insert(static_cast<const std::byte*>(handle));
}

bool WalledMemory::is_known(const std::byte* address) {
  return find(address) != blocks_.end() || permitted_.contains(address);
}

void WalledMemory::check_kernel(std::string_view name, std::span<const std::byte> kernel) {
  const std::lock_guard lock(mutex_);
  for_each_address(kernel, [&](const std::byte* address, size_t at) {
    if (is_known(address)) return;
    violations_.push_back("kernel '" + std::string(name) + "' holds an address outside the backend's memory at byte " +
                          std::to_string(at) + " of " + std::to_string(kernel.size()) +
                          "; give it a view of an Array on the backend's memory");
  });
}

void WalledMemory::check_data(std::string_view name, std::span<const std::byte> data) {
  const std::lock_guard lock(mutex_);
  begin_work(data.data());
  for_each_address(data, [&](const std::byte*, size_t at) {
    violations_.push_back("the array '" + std::string(name) + "' holds an address at byte " + std::to_string(at) +
                          " of " + std::to_string(data.size()) + "; use an index into another array");
  });
  end_work(data.data());
}

WalledMemory::Fault WalledMemory::open_after_fault(const std::byte* address) {
  const std::lock_guard lock(mutex_);
  const auto block = find(address);
  if (block == blocks_.end() || address >= block->first + block->second.mapped - page_bytes()) return Fault::foreign;
  if (block->second.access == Access::write) return Fault::permitted;  // another thread's fault opened it meanwhile
  const bool was_readable = block->second.access == Access::read;
  block->second.access = Access::write;
  protect(*block, Access::write);
  if (in_host_work_) {
    count(block->second);
    return Fault::permitted;
  }
  violations_.push_back("host code " + std::string(was_readable ? "wrote to" : "accessed") + " a block of " +
                        std::to_string(block->second.bytes) + " bytes after the launch of '" + last_launch_ +
                        "'; use read() or write() of its Array, or a launch");
  return Fault::violation;
}

void WalledMemory::on_fault(int signal, siginfo_t* info, void*) {
  WalledMemory* const memory = g_memory;
  const Fault fault = memory ? memory->open_after_fault(static_cast<const std::byte*>(info->si_addr)) : Fault::foreign;
  if (fault == Fault::violation) print_calls();
  if (fault != Fault::foreign) return;
  if (memory) ::sigaction(signal, &memory->previous_action_, nullptr);  // the access fails again, and ends the process
}

std::vector<std::string> WalledMemory::violations() const {
  const std::lock_guard lock(mutex_);
  return violations_;
}

}  // namespace relume::testing
