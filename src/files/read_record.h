// Records of the files that were read.
#pragma once

#include <filesystem>
#include <set>
#include <vector>

namespace relume {

/// Records the files that read_file() reads on any thread during the record's lifetime.
class ReadRecord {
 public:
  ReadRecord();
  ~ReadRecord();
  ReadRecord(const ReadRecord&) = delete;
  ReadRecord& operator=(const ReadRecord&) = delete;

  /// Files in the order of their first read.
  std::vector<std::filesystem::path> files() const;

 private:
  friend void record_read(const std::filesystem::path& file);
  std::vector<std::filesystem::path> files_;
  std::set<std::filesystem::path> known_;  ///< the same files, for fast lookup
};

/// Adds a file to every ReadRecord.
void record_read(const std::filesystem::path& file);

}  // namespace relume
