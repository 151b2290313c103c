// Files under temporary names.
#pragma once

#include <filesystem>

namespace relume {

/// An empty hidden file beside its target, with the target's extension; the destructor removes it. It is locked (flock)
/// during its writer's lifetime. The next writer of the same target removes files that a killed process left behind.
/// Stale files on network file systems are kept: other machines may not see the locks.
class TemporaryFile {
 public:
  /// Throws Error if the folder cannot be written.
  explicit TemporaryFile(const std::filesystem::path& target);
  ~TemporaryFile();
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  /// Renames it to `target`. Throws Error.
  void commit(const std::filesystem::path& target);

 private:
  bool create(const std::filesystem::path& path, bool lock);

  std::filesystem::path path_;  ///< empty after the rename
  int descriptor_ = -1;         ///< holds the lock
};

/// Whether `file` is a TemporaryFile of this process.
bool is_temporary_file(const std::filesystem::path& file);

/// Removes the temporary files of this process. Async-signal-safe, for signal handlers that end the process.
void remove_temporary_files() noexcept;

}  // namespace relume
