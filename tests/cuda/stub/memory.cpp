#include "stub/memory.h"

#include <sys/mman.h>
#include <unistd.h>

#include <cstring>

namespace stub {
namespace {

size_t mapped_bytes(size_t bytes) {
  static const auto page = static_cast<size_t>(::sysconf(_SC_PAGESIZE));
  return (bytes + page - 1) / page * page;
}

}  // namespace

void ManagedBlocks::clear() {
  for (const auto& [block, bytes] : blocks_) ::munmap(block, mapped_bytes(bytes));
  blocks_.clear();
  bytes_ = 0;
  open_ = true;
}

void* ManagedBlocks::allocate(size_t bytes) {
  void* const block = ::mmap(nullptr, mapped_bytes(bytes), PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (block == MAP_FAILED) return nullptr;
  std::memset(block, 0xa5, mapped_bytes(bytes));
  blocks_.emplace(static_cast<std::byte*>(block), bytes);
  bytes_ += bytes;
  if (!open_) ::mprotect(block, mapped_bytes(bytes), PROT_NONE);
  return block;
}

bool ManagedBlocks::free(void* block) {
  const auto found = blocks_.find(static_cast<std::byte*>(block));
  if (found == blocks_.end()) return false;
  ::munmap(block, mapped_bytes(found->second));
  bytes_ -= found->second;
  blocks_.erase(found);
  return true;
}

bool ManagedBlocks::contains(const void* address, size_t bytes) const {
  const auto* const begin = static_cast<const std::byte*>(address);
  auto after = blocks_.upper_bound(const_cast<std::byte*>(begin));
  if (after == blocks_.begin()) return false;
  --after;
  return begin + bytes <= after->first + after->second;
}

void ManagedBlocks::open() {
  if (open_) return;
  open_ = true;
  protect();
}

void ManagedBlocks::close() {
  if (!open_) return;
  open_ = false;
  protect();
}

void ManagedBlocks::protect() {
  for (const auto& [block, bytes] : blocks_)
    ::mprotect(block, mapped_bytes(bytes), open_ ? PROT_READ | PROT_WRITE : PROT_NONE);
}

}  // namespace stub
