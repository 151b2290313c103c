// Atomic file writes, and reads of whole files.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "files/temporary_file.h"

namespace relume {

/// Destination of writes to `file`: the end of a chain of symbolic links, existing or not; `file` itself if it is no
/// link.
std::filesystem::path link_target(const std::filesystem::path& file);

/// A TemporaryFile in the target's folder that external code writes; commit() renames it to the target. Without
/// commit() (after an exception) it is removed and the target is unchanged. Symbolic links are followed. Devices, pipes
/// and temporary files of this process are written directly, under their own name.
class PendingFile {
 public:
  /// Throws Error if the folder does not exist or cannot be written.
  explicit PendingFile(const std::filesystem::path& target);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  /// Path to write to.
  const std::filesystem::path& path() const { return temporary_ ? temporary_->path() : target_; }

  /// Renames the file to its target. Throws Error.
  void commit();

 private:
  std::filesystem::path target_;
  std::unique_ptr<TemporaryFile> temporary_;  ///< empty after the rename, or if the target is written directly
};

/// A PendingFile with its output stream.
class AtomicFile {
 public:
  /// Opens the temporary file. Throws Error if the folder does not exist or cannot be written.
  explicit AtomicFile(const std::filesystem::path& target);

  /// Binary output; seekable unless the target is a pipe.
  std::ostream& stream() { return stream_; }
  void write(std::span<const std::byte> bytes);

  /// Flushes the stream and closes it. Throws Error if a write failed (disk full).
  void close();
  /// Closes the file and renames it to its target. Throws Error.
  void commit();

 private:
  std::filesystem::path target_;
  PendingFile pending_;
  std::ofstream stream_;
};

/// Writes a file in one call, like AtomicFile.
void write_file(const std::filesystem::path& file, std::string_view contents);

/// Writes files that belong together: if one write fails, for example on a full disk, none is replaced. Throws Error.
void write_files(const std::vector<std::pair<std::filesystem::path, std::string>>& files);

/// All bytes of a file. Throws Error if it is missing, a folder, unreadable or larger than `max_bytes`.
std::vector<std::byte> read_file(const std::filesystem::path& file, uint64_t max_bytes = uint64_t{1} << 33);

}  // namespace relume
