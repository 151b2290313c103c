#include "io/assimp/trial_run.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <new>
#include <span>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/clock.h"
#include "core/error.h"

namespace relume {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kLimitAddressSpace = false;  // sanitizers reserve terabytes
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool kLimitAddressSpace = false;
#else
constexpr bool kLimitAddressSpace = true;
#endif
#else
constexpr bool kLimitAddressSpace = true;
#endif

/// Exit status of a child that has no memory left.
constexpr int kOutOfMemory = 3;
constexpr int kThrew = 4;

/// Why a child ended, beside the signals and exit statuses that waitpid() reports.
enum class Excess { none, memory, time };

struct ChildEnd {
  int status = 0;
  Excess excess = Excess::none;  ///< the limit for which the parent ended it
};

/// Pages of a process ("self" or its number), in bytes.
struct PagesInUse {
  uint64_t address_space = 0;
  uint64_t resident = 0;
};

PagesInUse pages_in_use(const std::string& process) {
  PagesInUse pages;
  std::ifstream("/proc/" + process + "/statm") >> pages.address_space >> pages.resident;
  const auto page_bytes = static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
  return {pages.address_space * page_bytes, pages.resident * page_bytes};
}

/// An unnamed file in memory.
class MemoryFile {
 public:
  MemoryFile() : descriptor_(memfd_create("relume", MFD_CLOEXEC)) {
    if (descriptor_ < 0)
      throw Error(fmt::format("no file in memory can be made (error {}); free some memory or close files", errno));
  }
  ~MemoryFile() { close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  bool write_all(std::span<const std::byte> bytes) const {
    while (!bytes.empty()) {
      const ssize_t written = write(descriptor_, bytes.data(), bytes.size());
      if (written < 0 && errno != EINTR) return false;
      if (written > 0) bytes = bytes.subspan(static_cast<size_t>(written));
    }
    return true;
  }

  Bytes read_all() const {
    Bytes bytes(static_cast<size_t>(std::max<off_t>(lseek(descriptor_, 0, SEEK_END), 0)));
    size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t count = pread(descriptor_, &bytes[done], bytes.size() - done, static_cast<off_t>(done));
      if (count < 0 && errno == EINTR) continue;
      if (count <= 0) break;
      done += static_cast<size_t>(count);
    }
    bytes.resize(done);
    return bytes;
  }

 private:
  int descriptor_;
};

void limit(__rlimit_resource resource, uint64_t soft, uint64_t hard) {
  const rlimit both{soft, hard};
  setrlimit(resource, &both);
}

/// Whatever handlers the parent has (crash reporters), the child just ends.
void reset_signals() {
  for (const int signal_number : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGXCPU, SIGINT, SIGTERM})
    std::signal(signal_number, SIG_DFL);
}

void silence_output() {
  const int null = open("/dev/null", O_WRONLY);
  if (null < 0) return;
  dup2(null, STDOUT_FILENO);
  dup2(null, STDERR_FILENO);
}

[[noreturn]] void run_child(const std::function<Bytes()>& task, const TrialLimits& limits, uint64_t address_space,
                            const MemoryFile& result) {
  constexpr uint64_t kGrace_s = 5;  // SIGXCPU comes first and tells this limit from others
  reset_signals();
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // a program that is ended meanwhile leaves nobody behind
  silence_output();
  limit(RLIMIT_CORE, 0, 0);
  limit(RLIMIT_CPU, limits.cpu_s, limits.cpu_s + kGrace_s);
  if (kLimitAddressSpace) limit(RLIMIT_AS, address_space, address_space);
  // Libraries that catch std::bad_alloc would report a damaged file.
  std::set_new_handler([] { _exit(kOutOfMemory); });
  try {
    if (!result.write_all(task())) _exit(kOutOfMemory);
  } catch (...) {
    _exit(kThrew);
  }
  _exit(0);
}

/// Waits for the child and ends it where it exceeds a limit that the kernel does not check.
ChildEnd wait_for(pid_t child, double wall_s, uint64_t resident_limit) {
  constexpr useconds_t kLongestPause_us = 10'000;
  const double deadline_s = now_s() + wall_s;
  useconds_t pause_us = 100;
  ChildEnd end;
  int options = WNOHANG;
  while (true) {
    const pid_t ended = waitpid(child, &end.status, options);
    if (ended == child) return end;
    if (ended < 0 && errno != EINTR)
      throw Error("the process that reads the file ended unseen; start relume another way");
    if (end.excess == Excess::none) {
      if (pages_in_use(std::to_string(child)).resident > resident_limit) end.excess = Excess::memory;
      if (now_s() > deadline_s) end.excess = Excess::time;
    }
    if (end.excess != Excess::none) {
      kill(child, SIGKILL);
      options = 0;
      continue;
    }
    usleep(pause_us);
    pause_us = std::min(2 * pause_us, kLongestPause_us);
  }
}

/// The sentence after "place: " for a child that gave no result; empty if it ended well.
std::string problem_of(const ChildEnd& end, const TrialLimits& limits) {
  constexpr const char* kRemedy = "the file is likely damaged; export it again or convert it to glTF";
  constexpr double kMebibyte = 1 << 20;
  const int signal_number = WIFSIGNALED(end.status) ? WTERMSIG(end.status) : 0;
  const int exit_status = WIFEXITED(end.status) ? WEXITSTATUS(end.status) : 0;
  if (end.excess == Excess::memory || exit_status == kOutOfMemory)
    return fmt::format("reading needs more than {:.0f} MiB of memory, the limit for a file of its size; {}",
                       static_cast<double>(limits.memory_bytes) / kMebibyte, kRemedy);
  if (end.excess == Excess::time)
    return fmt::format("reading took longer than {:.0f} s, the limit for a file of its size; {}", limits.wall_s,
                       kRemedy);
  if (signal_number == SIGXCPU)
    return fmt::format("reading took more than {} s of processor time, the limit for a file of its size; {}",
                       limits.cpu_s, kRemedy);
  if (signal_number == SIGINT || signal_number == SIGTERM) return "reading was interrupted; load the file again";
  if (signal_number == SIGKILL)
    return "the system ended the process that reads the file, likely for lack of memory; free some memory";
  if (signal_number != 0) return fmt::format("reading crashed (signal {}); {}", signal_number, kRemedy);
  if (exit_status != 0) return fmt::format("reading crashed (exit status {}); {}", exit_status, kRemedy);
  return {};
}

}  // namespace

Bytes run_trial(const std::function<Bytes()>& task, const TrialLimits& limits, const std::string& place) {
  const PagesInUse own = pages_in_use("self");
  const MemoryFile result;
  const pid_t child = fork();
  if (child < 0)
    throw Error(fmt::format(
        "{}: no process can be started to read the file; free some memory or raise the limit on processes", place));
  if (child == 0) run_child(task, limits, own.address_space + limits.memory_bytes, result);
  const ChildEnd end = wait_for(child, limits.wall_s, own.resident + limits.memory_bytes);
  const std::string problem = problem_of(end, limits);
  if (!problem.empty()) throw Error(fmt::format("{}: {}", place, problem));
  return result.read_all();
}

}  // namespace relume
