#include "files/temporary_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#if defined(__linux__)
#include <sys/vfs.h>
#endif

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <mutex>
#include <random>
#include <system_error>

#include <fmt/format.h>

#include "relume/error.h"

namespace relume {
namespace {

namespace fs = std::filesystem;

// Limits within the 255 bytes of a file name. No output format has a longer extension.
constexpr size_t kStemBytes = 200;
constexpr size_t kExtensionBytes = 32;
constexpr uint64_t kTags = 16;  // maximum number of concurrent writers of one target with recognisable names

// Signal handlers take no user argument, hence a global. Code that removes a pointer from its slot owns the text.
std::array<std::atomic<char*>, 64> g_paths{};
std::mutex g_paths_mutex;  // for all users except the handler
std::atomic<int> g_handler_waits{0};

void register_path(const fs::path& path) {
  const std::scoped_lock lock(g_paths_mutex);
  char* text = strdup(path.c_str());
  for (std::atomic<char*>& place : g_paths) {
    char* none = nullptr;
    if (place.compare_exchange_strong(none, text)) return;
  }
  std::free(text);  // all slots in use: the next writer of the target finds the file
}

void unregister_path(const fs::path& path) {
  const std::scoped_lock lock(g_paths_mutex);
  for (std::atomic<char*>& place : g_paths) {
    char* text = place.load();
    if (text && path == text && place.compare_exchange_strong(text, nullptr)) return std::free(text);
  }
}

/// Guards times in which a file and its entry in g_paths may disagree. A handler on another thread waits; on this
/// thread, signals are blocked.
class HandlerWaits {
 public:
  HandlerWaits() {
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_BLOCK, &all, &before_);
    ++g_handler_waits;
  }
  ~HandlerWaits() {
    --g_handler_waits;
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  HandlerWaits(const HandlerWaits&) = delete;
  HandlerWaits& operator=(const HandlerWaits&) = delete;

 private:
  sigset_t before_;
};

fs::path folder_of(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : fs::path("."); }

/// A hidden name, so that globs like *.exr do not match it.
fs::path name_for(const fs::path& target, uint64_t tag) {
  return target.parent_path() / fmt::format(".{}.{:x}.tmp{}", target.stem().string().substr(0, kStemBytes), tag,
                                            target.extension().string().substr(0, kExtensionBytes));
}

uint64_t random_tag() {
  std::random_device random;
  return (static_cast<uint64_t>(random()) << 32) | random();
}

/// Whether all writers in the folder see its locks, and the lock's owner may write through another descriptor. Network
/// file systems may not guarantee this.
bool keeps_locks(const fs::path& folder) {
#if defined(__linux__)
  // NFS, CIFS, SMB, SMB2, FUSE, 9P, Ceph, AFS, Coda (statfs(2)); Lustre, GPFS, BeeGFS.
  constexpr std::array<uint32_t, 12> kRemote{0x6969,     0xff534d42, 0x517b,     0xfe534d42, 0x65735546, 0x01021997,
                                             0x00c36400, 0x5346414f, 0x73757245, 0x0bd00bd0, 0x47504653, 0x19830326};
  struct statfs info {};
  if (statfs(folder.c_str(), &info) != 0) return false;
  return std::find(kRemote.begin(), kRemote.end(), static_cast<uint32_t>(info.f_type)) == kRemote.end();
#else
  return !folder.empty();
#endif
}

/// Removes the file unless a live writer has locked it.
void remove_if_stale(const fs::path& path) {
  const int descriptor = open(path.c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0) return;
  struct stat opened {};
  struct stat named {};
  const bool stale = fstat(descriptor, &opened) == 0 && S_ISREG(opened.st_mode) &&
                     flock(descriptor, LOCK_EX | LOCK_NB) == 0 && lstat(path.c_str(), &named) == 0 &&
                     named.st_ino == opened.st_ino && named.st_dev == opened.st_dev;
  if (stale) unlink(path.c_str());
  close(descriptor);
}

}  // namespace

TemporaryFile::TemporaryFile(const fs::path& target) {
  const fs::path folder = folder_of(target);
  bool made = false;
  const bool lock = keeps_locks(folder);
  const HandlerWaits wait;
  for (uint64_t tag = 0; lock && tag < kTags; ++tag) remove_if_stale(name_for(target, tag));
  for (uint64_t tag = 0; lock && !made && tag < kTags; ++tag) made = create(name_for(target, tag), true);
  if (!made && !create(name_for(target, random_tag()), false)) {
    throw Error(ErrorCode::io, fmt::format("{}: cannot be written ({}); check the permissions of {}", target.string(),
                                           std::strerror(errno), folder.string()));
  }
  register_path(path_);
}

/// Returns false if the file exists, or if another writer removes it as stale before it is locked.
bool TemporaryFile::create(const fs::path& path, bool lock) {
  const int descriptor = open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (descriptor < 0) return false;
  struct stat info {};
  const bool lost = lock && ((flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) ||
                             fstat(descriptor, &info) != 0 || info.st_nlink == 0);
  if (lost) {
    close(descriptor);
    return false;
  }
  path_ = path;
  descriptor_ = descriptor;
  return true;
}

TemporaryFile::~TemporaryFile() {
  if (!path_.empty()) {
    const HandlerWaits wait;
    unregister_path(path_);
    unlink(path_.c_str());
  }
  close(descriptor_);
}

void TemporaryFile::commit(const fs::path& target) {
  const HandlerWaits wait;
  unregister_path(path_);
  std::error_code error;
  fs::rename(path_, target, error);
  if (error)
    throw Error(ErrorCode::io,
                fmt::format("{}: cannot be replaced ({}); choose another name", target.string(), error.message()));
  path_.clear();
}

bool is_temporary_file(const fs::path& file) {
  const std::scoped_lock lock(g_paths_mutex);
  return std::any_of(g_paths.begin(), g_paths.end(), [&](const std::atomic<char*>& place) {
    const char* text = place.load();
    return text && file == text;
  });
}

void remove_temporary_files() noexcept {
  constexpr timespec kMillisecond{0, 1'000'000};
  for (int i = 0; i < 1000 && g_handler_waits.load() > 0; ++i) nanosleep(&kMillisecond, nullptr);
  for (std::atomic<char*>& place : g_paths) {
    if (const char* text = place.exchange(nullptr)) unlink(text);
  }
}

}  // namespace relume
