// Files that exist completely or not at all, and files read whole.
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <span>
#include <string_view>
#include <vector>

namespace relume {

/// Collects output under a temporary name in the target's folder and renames it when commit() is called. Without
/// commit() (an exception on the way) the temporary file is removed and the target stays as it was. A symbolic link
/// is followed; devices and pipes are written directly.
class AtomicFile {
 public:
  /// Opens the temporary file. Throws Error if the folder does not exist or cannot be written.
  explicit AtomicFile(const std::filesystem::path& target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Binary output; seekable unless the target is a pipe.
  std::ostream& stream() { return stream_; }
  void write(std::span<const std::byte> bytes);

  /// Gives the file its name. Throws Error if anything could not be written (disk full).
  void commit();

 private:
  std::filesystem::path target_;
  std::filesystem::path temporary_;  ///< empty once renamed, or when the target is written directly
  std::ofstream stream_;
};

/// AtomicFile in one call.
void write_file(const std::filesystem::path& file, std::string_view contents);

/// All bytes of a file. Throws Error if it is missing, a folder, unreadable or larger than `max_bytes`.
std::vector<std::byte> read_file(const std::filesystem::path& file, uint64_t max_bytes = uint64_t{1} << 33);

}  // namespace relume
