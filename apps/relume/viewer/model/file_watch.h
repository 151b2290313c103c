// Detects changes of files on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

namespace relume::viewer {

/// Polls the files of a scene. A change is reported once the files have stayed the same for a moment, because programs
/// write in pieces.
class FileWatch {
 public:
  /// Replaces the watched files, which may be missing; only the first must exist for a change to be reported. A file
  /// changes if it was watched before and differs from the last poll, or was written after `read_from`, the time at
  /// which reading began.
  void watch(const std::vector<std::filesystem::path>& files,
             std::filesystem::file_time_type read_from = std::filesystem::file_time_type::max());

  /// Whether the files have changed since the last call that returned true. Polls at most every 0.25 s.
  bool changed(double now_s);

 private:
  struct Stamp {
    bool exists = false;
    uint64_t size = 0;
    std::filesystem::file_time_type written{};
    friend bool operator==(const Stamp&, const Stamp&) = default;
  };
  static Stamp stamp_of(const std::filesystem::path& file);

  std::filesystem::path main_;
  std::map<std::filesystem::path, Stamp> stamps_;
  double looked_s_ = -1e9;
  double settles_s_ = 0;  ///< time at which a detected change is reported
  bool unsettled_ = false;
};

}  // namespace relume::viewer
