// Which files a command reads and writes, so that none takes the place of another.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace relume::cli {

/// Throws UsageError unless `file` can be written: its folder exists and takes it, its name is not too long, and it is
/// no folder itself.
void check_output_file(const std::filesystem::path& file);

/// The files of a command by what they are for, such as "-o", "--stats" or "SCENE". Whatever way they are spelt, and
/// through symbolic and hard links, an output is neither an input nor another output. A file may have one role twice.
/// Devices and pipes may have any.
class FileRoles {
 public:
  /// Throws UsageError if another role writes it. An empty name and a file that does not exist are ignored.
  void reads(std::string_view role, const std::filesystem::path& file);
  void reads(std::string_view role, const std::vector<std::filesystem::path>& files);
  /// Throws UsageError if another role reads or writes it. An empty name is ignored.
  void writes(std::string_view role, const std::filesystem::path& file);

 private:
  struct Use {
    std::string role;
    std::filesystem::path file;
  };
  /// Of a file that exists: device and number. Of others: their canonical name.
  using Identity = std::pair<std::pair<uint64_t, uint64_t>, std::string>;

  Identity identity_of(const std::filesystem::path& file);

  std::map<Identity, Use> inputs_;
  std::map<Identity, Use> outputs_;
  std::filesystem::path folder_;  ///< whose canonical name is in `canonical_folder_`
  std::filesystem::path canonical_folder_;
};

}  // namespace relume::cli
