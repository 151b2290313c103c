// Files under temporary names.
#pragma once

#include <filesystem>

namespace relume {

/// An empty file beside its target, hidden, with the target's extension; its destructor removes it. It is locked
/// (flock) while its writer lives: the next writer of the same target removes those that a killed process has left.
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

  std::filesystem::path path_;  ///< empty once renamed
  int descriptor_ = -1;         ///< holds the lock
};

/// Whether `file` is a TemporaryFile of this process.
bool is_temporary_file(const std::filesystem::path& file);

/// Removes those of this process. For signal handlers that end it: async-signal-safe.
void remove_temporary_files() noexcept;

}  // namespace relume
