#include "files/atomic_file.h"

#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <deque>
#include <system_error>

#include <fmt/format.h>

#include "files/read_record.h"
#include "files/temporary_file.h"
#include "relume/error.h"

namespace relume {
namespace {

namespace fs = std::filesystem;

std::string reason() { return errno != 0 ? std::strerror(errno) : "unknown reason"; }

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

/// The process's file size limit as the end of a sentence; empty if unlimited.
std::string size_limit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_FSIZE, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return {};
  return fmt::format(", and the limit of {} bytes a file (ulimit -f)", limit.rlim_cur);
}

}  // namespace

fs::path link_target(const fs::path& file) {
  constexpr int kMostLinks = 40;  // limit of Linux
  std::error_code failure;
  if (!fs::is_symlink(file, failure)) return file;
  if (fs::exists(file, failure)) {
    fs::path target = fs::canonical(file, failure);
    return failure ? file : target;  // pipes have no name
  }
  fs::path target = file;
  for (int i = 0; i < kMostLinks && fs::is_symlink(target, failure); ++i) {
    target = target.parent_path() / fs::read_symlink(target, failure);
    if (failure) return file;
  }
  return fs::is_symlink(target, failure) ? file : target;
}

PendingFile::PendingFile(const fs::path& target) : target_(link_target(target)) {
  std::error_code ignored;
  if (target_.filename().empty() || fs::is_directory(target_, ignored))
    throw Error(fmt::format("{}: this is a folder; give the name of a file in it", target.string()));
  const fs::path folder = folder_of(target_);
  if (!fs::is_directory(folder, ignored))
    throw Error(ErrorCode::io,
                fmt::format("{}: the folder {} does not exist; create it first", target.string(), folder.string()));
  const bool special = fs::exists(target_, ignored) && !fs::is_regular_file(target_, ignored);
  if (!special && !is_temporary_file(target_)) temporary_ = std::make_unique<TemporaryFile>(target_);
}

PendingFile::~PendingFile() = default;

void PendingFile::commit() {
  if (temporary_) temporary_->commit(target_);
  temporary_.reset();
}

AtomicFile::AtomicFile(const fs::path& target) : target_(target), pending_(target) {
  errno = 0;
  stream_.open(pending_.path(), std::ios::binary | std::ios::trunc);
  if (!stream_)
    throw Error(ErrorCode::io, fmt::format("{}: cannot be written ({}); check the permissions of {}", target_.string(),
                                           reason(), folder_of(pending_.path()).string()));
}

void AtomicFile::write(std::span<const std::byte> bytes) {
  stream_.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

void AtomicFile::close() {
  if (!stream_.is_open()) return;
  const bool failed_before = !stream_;  // errno no longer belongs to the write
  errno = 0;
  stream_.close();
  if (!stream_) {
    throw Error(ErrorCode::io,
                fmt::format("{}: writing failed ({}); check the free space{}", target_.string(),
                            failed_before ? "the disk is full, or the file too large" : reason(), size_limit()));
  }
}

void AtomicFile::commit() {
  close();
  pending_.commit();
}

void write_file(const fs::path& file, std::string_view contents) {
  AtomicFile out(file);
  out.stream().write(contents.data(), static_cast<std::streamsize>(contents.size()));
  out.commit();
}

void write_files(const std::vector<std::pair<fs::path, std::string>>& files) {
  std::deque<AtomicFile> open;
  for (const auto& [file, contents] : files) {
    AtomicFile& out = open.emplace_back(file);
    out.stream().write(contents.data(), static_cast<std::streamsize>(contents.size()));
    out.close();
  }
  for (AtomicFile& out : open) out.commit();
}

std::vector<std::byte> read_file(const fs::path& file, uint64_t max_bytes) {
  record_read(file);
  std::error_code error;
  const fs::file_status status = fs::status(file, error);
  if (!fs::exists(status))
    throw Error(ErrorCode::not_found, fmt::format("{}: the file does not exist; check its name", file.string()));
  if (fs::is_directory(status))
    throw Error(fmt::format("{}: this is a folder; give the name of a file", file.string()));
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in)
    throw Error(ErrorCode::io,
                fmt::format("{}: cannot be opened ({}); check its permissions", file.string(), reason()));
  std::vector<std::byte> bytes;
  if (fs::is_regular_file(status)) {
    const uint64_t size = fs::file_size(file, error);
    if (!error && size <= max_bytes) bytes.reserve(size);
  } else {
    max_bytes = std::min(max_bytes, uint64_t{1} << 30);  // devices may be endless
  }
  // Reads in blocks: the size of a pipe is unknown, and a file may grow during reading.
  std::vector<char> block(size_t{1} << 20);
  while (in) {
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    const auto count = static_cast<size_t>(in.gcount());
    if (bytes.size() + count > max_bytes)
      throw Error(fmt::format("{}: the file is larger than the limit of {} bytes; use a smaller one", file.string(),
                              max_bytes));
    const auto* begin = reinterpret_cast<const std::byte*>(block.data());
    bytes.insert(bytes.end(), begin, begin + count);
  }
  if (in.bad())
    throw Error(ErrorCode::io, fmt::format("{}: reading failed ({}); check the device", file.string(), reason()));
  return bytes;
}

}  // namespace relume
