#include "cli/file_roles.h"

#include <system_error>

#include <fmt/format.h>

#include "cli/command.h"
#include "cli/platform.h"
#include "files/atomic_file.h"

namespace relume::cli {
namespace {

namespace fs = std::filesystem;

constexpr size_t kMostNameBytes = 255;   // of every component of a path (NAME_MAX)
constexpr size_t kMostPathBytes = 4095;  // PATH_MAX without the terminating zero

/// A name for use in a sentence; long ones are cut.
std::string shown(const fs::path& file) {
  constexpr size_t kMost = 80;
  const std::string name = file.string();
  if (name.size() <= kMost) return name;
  size_t end = kMost;
  while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xc0) == 0x80) --end;  // within a UTF-8 character
  return name.substr(0, end) + "…";
}

void check_name_lengths(const fs::path& file) {
  if (file.string().size() > kMostPathBytes) {
    throw UsageError(fmt::format("{}: the path has {} bytes, but may have {} at most; choose a shorter one",
                                 shown(file), file.string().size(), kMostPathBytes));
  }
  for (const fs::path& part : file) {
    if (part.string().size() <= kMostNameBytes) continue;
    throw UsageError(fmt::format("{}: the name {} has {} bytes, but may have {} at most; choose a shorter one",
                                 shown(file), shown(part), part.string().size(), kMostNameBytes));
  }
}

bool is_special(const fs::path& file) {
  std::error_code failure;
  const fs::file_status status = fs::status(file, failure);
  return fs::exists(status) && !fs::is_regular_file(status);
}

}  // namespace

void check_no_folder(const fs::path& file) {
  std::error_code failure;
  if (fs::is_directory(file, failure))
    throw UsageError(fmt::format("{} is a folder; name a file in it, or choose another name", file.string()));
}

void check_output_file(const fs::path& file) {
  check_name_lengths(file);
  const fs::path folder = file.parent_path();
  std::error_code failure;
  if (!folder.empty() && !fs::is_directory(folder, failure)) {
    throw UsageError(fmt::format("{}: the folder {} does not exist; create it first", file.string(), folder.string()));
  }
  check_no_folder(file);
  const bool special = is_special(file);
  if (special ? !is_writable(file.string()) : !folder_is_writable(folder.string())) {
    throw UsageError(fmt::format("{}: the {} cannot be written to; choose another or change its permissions",
                                 file.string(), special ? "device" : "folder"));
  }
  try {
    const PendingFile probe(file);
  } catch (const Error& error) {
    throw UsageError(error.what());
  }
}

bool make_output_folder(const fs::path& folder) {
  std::error_code failure;
  const bool is_new = fs::create_directories(folder, failure);
  if (failure)
    throw UsageError(fmt::format("{}: the folder cannot be created ({}); choose another with -o", folder.string(),
                                 failure.message()));
  return is_new;
}

FileRoles::Identity FileRoles::identity_of(const fs::path& file) {
  if (const auto number = file_number(file.string())) return {*number, ""};
  const fs::path target = link_target(file);
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (folder != folder_ || canonical_folder_.empty()) {  // a sequence has one folder and many names
    std::error_code failure;
    folder_ = folder;
    canonical_folder_ = fs::weakly_canonical(folder, failure);
    if (failure) canonical_folder_ = fs::absolute(folder, failure).lexically_normal();
    if (failure) canonical_folder_ = folder.lexically_normal();
  }
  return {{0, 0}, (canonical_folder_ / target.filename()).string()};
}

void FileRoles::reads(std::string_view role, const fs::path& file) {
  std::error_code failure;
  if (file.empty() || !fs::is_regular_file(file, failure)) return;
  const Identity identity = identity_of(file);
  inputs_.try_emplace(identity, Use{std::string(role), file});
  const auto output = outputs_.find(identity);
  if (output == outputs_.end() || output->second.role == role) return;
  throw UsageError(fmt::format("{} would replace {}, which {} reads; choose another name for {}", output->second.role,
                               output->second.file.string(), role, output->second.role));
}

void FileRoles::reads(std::string_view role, const std::vector<fs::path>& files) {
  for (const fs::path& file : files) reads(role, file);
}

void FileRoles::writes(std::string_view role, const fs::path& file) {
  if (file.empty() || is_special(file)) return;
  const Identity identity = identity_of(file);
  if (const auto input = inputs_.find(identity); input != inputs_.end() && input->second.role != role) {
    throw UsageError(fmt::format("{} would replace {}, which {} reads; choose another name for {}", role, file.string(),
                                 input->second.role, role));
  }
  const Use& first = outputs_.try_emplace(identity, Use{std::string(role), file}).first->second;
  if (first.role == role) return;
  throw UsageError(first.file == file
                       ? fmt::format("{} and {} would both write {}; choose another name for one of them", first.role,
                                     role, file.string())
                       : fmt::format("{} and {} would write the same file, as {} and as {}; choose another name for "
                                     "one of them",
                                     first.role, role, first.file.string(), file.string()));
}

bool FileRoles::has_output(const fs::path& file) { return outputs_.contains(identity_of(file)); }

}  // namespace relume::cli
