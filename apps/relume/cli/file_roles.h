// The files that a command reads and writes, to detect conflicts.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace relume::cli {

/// Throws UsageError if `file` is a folder.
void check_no_folder(const std::filesystem::path& file);

/// Throws UsageError if `file` cannot be written: its folder must exist and be writable, its name short enough, and it
/// must not be a folder.
void check_output_file(const std::filesystem::path& file);

/// Creates the folder of -o with its parents, and returns whether it is new. Throws UsageError.
bool make_output_folder(const std::filesystem::path& folder);

/// The files of a command by role, such as "-o", "--stats" or "SCENE". An output must be neither an input nor another
/// output, under any spelling and through symbolic and hard links. A file may have one role twice. Devices and pipes
/// may have any.
class FileRoles {
 public:
  /// Throws UsageError if another role writes it. Ignores an empty name and a file that does not exist.
  void reads(std::string_view role, const std::filesystem::path& file);
  void reads(std::string_view role, const std::vector<std::filesystem::path>& files);
  /// Throws UsageError if another role reads or writes it. Ignores an empty name.
  void writes(std::string_view role, const std::filesystem::path& file);
  /// Whether a role writes the file.
  bool has_output(const std::filesystem::path& file);

 private:
  struct Use {
    std::string role;
    std::filesystem::path file;
  };
  /// For an existing file: device and number. For others: the canonical name.
  using Identity = std::pair<std::pair<uint64_t, uint64_t>, std::string>;

  Identity identity_of(const std::filesystem::path& file);

  std::map<Identity, Use> inputs_;
  std::map<Identity, Use> outputs_;
  std::filesystem::path folder_;  ///< folder whose canonical name is in `canonical_folder_`
  std::filesystem::path canonical_folder_;
};

}  // namespace relume::cli
