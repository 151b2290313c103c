#include "viewer/model/file_watch.h"

#include <system_error>
#include <utility>

namespace relume::viewer {
namespace {

constexpr double kInterval_s = 0.25;
constexpr double kSettle_s = 0.4;

}  // namespace

FileWatch::Stamp FileWatch::stamp_of(const std::filesystem::path& file) {
  std::error_code failure;
  Stamp stamp;
  const auto status = std::filesystem::status(file, failure);
  if (failure || !std::filesystem::is_regular_file(status)) return stamp;
  stamp.exists = true;
  stamp.size = std::filesystem::file_size(file, failure);
  stamp.written = std::filesystem::last_write_time(file, failure);
  return stamp;
}

void FileWatch::watch(const std::vector<std::filesystem::path>& files, std::filesystem::file_time_type read_from) {
  std::map<std::filesystem::path, Stamp> stamps;
  for (const std::filesystem::path& file : files) {
    const auto known = stamps_.find(file);
    Stamp stamp = known != stamps_.end() ? known->second : stamp_of(file);
    if (known == stamps_.end() && stamp.exists && stamp.written > read_from)
      stamp = {};  // the version read may be older
    stamps[file] = stamp;
  }
  stamps_ = std::move(stamps);
  const std::filesystem::path before = std::exchange(main_, files.empty() ? std::filesystem::path() : files.front());
  unsettled_ = unsettled_ && before == main_;
}

bool FileWatch::changed(double now_s) {
  if (now_s - looked_s_ < kInterval_s) return false;
  looked_s_ = now_s;
  for (auto& [file, stamp] : stamps_) {
    const Stamp now = stamp_of(file);
    if (now == stamp) continue;
    stamp = now;
    unsettled_ = true;
    settles_s_ = now_s + kSettle_s;
  }
  if (!unsettled_ || now_s < settles_s_ || !stamps_[main_].exists) return false;
  unsettled_ = false;
  return true;
}

}  // namespace relume::viewer
