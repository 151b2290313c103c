// Files that exist completely or not at all, and files read whole.
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

/// Where the bytes of `file` go: the end of a chain of symbolic links, existing or not; `file` if it is no link.
std::filesystem::path link_target(const std::filesystem::path& file);

/// A TemporaryFile in the target's folder that somebody else writes; commit() renames it to the target. Without
/// commit() (an exception on the way) it is removed and the target stays as it was. A symbolic link is followed.
/// Devices, pipes and temporary files of this process are written directly, under their own name.
class PendingFile {
 public:
  /// Throws Error if the folder does not exist or cannot be written.
  explicit PendingFile(const std::filesystem::path& target);
  ~PendingFile();
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;

  /// Where to write.
  const std::filesystem::path& path() const { return temporary_ ? temporary_->path() : target_; }

  /// Gives the file its name. Throws Error.
  void commit();

 private:
  std::filesystem::path target_;
  std::unique_ptr<TemporaryFile> temporary_;  ///< none once renamed, or when the target is written directly
};

/// A PendingFile written here.
class AtomicFile {
 public:
  /// Opens the temporary file. Throws Error if the folder does not exist or cannot be written.
  explicit AtomicFile(const std::filesystem::path& target);

  /// Binary output; seekable unless the target is a pipe.
  std::ostream& stream() { return stream_; }
  void write(std::span<const std::byte> bytes);

  /// Writes what is left to write. Throws Error if anything could not be written (disk full).
  void close();
  /// Closes, and gives the file its name. Throws Error.
  void commit();

 private:
  std::filesystem::path target_;
  PendingFile pending_;
  std::ofstream stream_;
};

/// AtomicFile in one call.
void write_file(const std::filesystem::path& file, std::string_view contents);

/// Files that belong together: where one cannot be written, as on a full disk, none is replaced. Throws Error.
void write_files(const std::vector<std::pair<std::filesystem::path, std::string>>& files);

/// All bytes of a file. Throws Error if it is missing, a folder, unreadable or larger than `max_bytes`.
std::vector<std::byte> read_file(const std::filesystem::path& file, uint64_t max_bytes = uint64_t{1} << 33);

}  // namespace relume
