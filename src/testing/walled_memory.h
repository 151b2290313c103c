// Memory for tests that record forbidden accesses. Its blocks are closed to the host, like a device's memory, except
// - during launches, when kernels access them; code that a backend times like a kernel counts as one;
// - from Array::read() or write() on, until the end of the next launch: the end of a span's use cannot be detected.
// Tests can limit the size of the blocks that read() and write() open, and count the blocks that timed host code uses.
// Accesses to closed blocks are recorded and then permitted. Kernels are searched for addresses of other memory, and
// arrays for any addresses.
#pragma once

#include <csignal>
#include <cstddef>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/array.h"
#include "core/view.h"

namespace relume::testing {

/// One may exist at a time, because it handles the process's segmentation faults.
class WalledMemory final : public Memory {
 public:
  /// All blocks are open until the first end_launch().
  WalledMemory();
  ~WalledMemory() override;
  WalledMemory(const WalledMemory&) = delete;
  WalledMemory& operator=(const WalledMemory&) = delete;

  void* allocate(size_t bytes, size_t alignment) override;
  void deallocate(void* block, size_t bytes, size_t alignment) noexcept override;
  void open_for_reading(const void* block) override;
  void open_for_writing(void* block) override;
  /// Like a device, these two are no accesses of host code, and close their blocks between launches.
  void copy(void* to, const void* from, size_t bytes) override;
  void zero(void* to, size_t bytes) override;

  /// Open and close all blocks. Call them at the beginning and end of the launch `name`. The blocks stay open until the
  /// end of the outermost launch.
  void begin_launch(std::string_view name);
  void end_launch();

  /// Records a violation for each block of more than `bytes` that host code opens between launches. Larger blocks hold
  /// data of a frame, which launches process. `except`: sizes of larger blocks that it may open, bytes. Unlimited at
  /// first.
  void limit_host_access(size_t bytes, std::set<size_t> except = {});
  void permit_host_access() { limit_host_access(std::numeric_limits<size_t>::max()); }

  /// Call it before each kernel, also before those that timed host code launches.
  void announce_kernel();
  /// From the next launch on, counts the blocks that host code accesses in a launch before the first kernel. Each block
  /// counts once in a launch; copy() and zero() do not count.
  void count_host_work();
  /// Their bytes, the most in a launch of each name.
  std::map<std::string, size_t> host_work() const;

  /// Permits one address in kernels: a handle of the host. Null: nothing.
  void permit(const void* handle);
  /// Records a violation for each address in a kernel that is mapped, but neither in a block nor permitted. `kernel`:
  /// its bytes, with zeros between members. Searches aligned words above 4 GiB, where 64-bit processes have their
  /// memory.
  void check_kernel(std::string_view name, std::span<const std::byte> kernel);
  /// Records a violation for each mapped address in the elements of an array, which hold none. Call it in a launch.
  /// `name`: of the array, for the sentence.
  template <typename T>
  void check_elements(std::string_view name, const View<T>& elements) {
    check_data(name, std::as_bytes(std::span(elements.data, elements.size)));
  }

  /// The violations so far, one sentence each.
  std::vector<std::string> violations() const;

 private:
  enum class Access : uint8_t { none, read, write };
  struct Block {
    size_t bytes;
    size_t mapped;
    Access access;
    bool counted = false;  ///< in the current host work
  };
  enum class Fault : uint8_t { foreign, permitted, violation };
  using Blocks = std::map<std::byte*, Block>;

  static void on_fault(int signal, siginfo_t* info, void* context);
  /// Opens the block of an address after an access while it was closed. `foreign`: the address is in no block, or
  /// behind its end.
  Fault open_after_fault(const std::byte* address);
  Blocks::iterator find(const std::byte* address);
  void open(const std::byte* address, Access access);
  static void protect(const Blocks::value_type& block, Access access);
  void open_all();
  void close_all();
  void count(Block& block);
  /// Opens and closes the block of an address, if it is in one, for work of the device.
  void begin_work(const void* address);
  void end_work(const void* address);
  bool is_known(const std::byte* address);
  void check_data(std::string_view name, std::span<const std::byte> data);

  mutable std::mutex mutex_;
  Blocks blocks_;
  std::set<const std::byte*> permitted_;
  int launches_ = 1;                                        ///< that have begun and not ended
  size_t host_limit_ = std::numeric_limits<size_t>::max();  ///< largest block that host code may open
  std::set<size_t> unlimited_;                              ///< sizes of larger blocks that it may open
  std::string last_launch_ = "none";
  bool counts_host_work_ = false;
  bool has_kernel_ = false;    ///< whether a kernel has been announced, whose launch has not ended
  bool in_host_work_ = false;  ///< in a launch without a kernel so far; blocks are closed until the first access
  size_t work_bytes_ = 0;      ///< counted in the current launch
  std::map<std::string, size_t> host_work_;
  std::vector<std::string> violations_;
  struct sigaction previous_action_ {};
};

}  // namespace relume::testing
