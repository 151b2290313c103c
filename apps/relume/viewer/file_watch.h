// Notices that files change on disk.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <vector>

namespace relume::viewer {

/// Looks at the files of a scene from time to time. A change counts once the files have stayed as they are for a
/// moment, as programs write in pieces.
class FileWatch {
 public:
  /// Watches these files, missing ones included, in place of those before; the first has to exist for a change to
  /// count. A file that was watched before and has changed since the last look counts as changed, and so does one that
  /// was written after `read_from`, when reading them began.
  void watch(const std::vector<std::filesystem::path>& files,
             std::filesystem::file_time_type read_from = std::filesystem::file_time_type::max());

  /// Whether the files have changed since the last time that this was true. Looks at them every 0.25 s at most.
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
  double settles_s_ = 0;  ///< when a change counts that was seen
  bool unsettled_ = false;
};

}  // namespace relume::viewer
