// Memory of the stub driver's device.
#pragma once

#include <cstddef>
#include <map>

namespace stub {

/// Managed memory. The host cannot access it while it is closed: an access ends the process.
class ManagedBlocks {
 public:
  ManagedBlocks() = default;
  ~ManagedBlocks() { clear(); }
  ManagedBlocks(const ManagedBlocks&) = delete;
  ManagedBlocks& operator=(const ManagedBlocks&) = delete;

  /// A block that is filled with a pattern; nullptr if the system has no memory.
  void* allocate(size_t bytes);
  /// Returns false if there is no such block.
  bool free(void* block);
  /// Whether the bytes from `address` on are in one block.
  bool contains(const void* address, size_t bytes) const;

  void clear();
  void open();
  void close();
  bool is_open() const { return open_; }

  size_t count() const { return blocks_.size(); }
  size_t bytes() const { return bytes_; }

 private:
  void protect();

  std::map<std::byte*, size_t> blocks_;
  size_t bytes_ = 0;
  bool open_ = true;
};

}  // namespace stub
