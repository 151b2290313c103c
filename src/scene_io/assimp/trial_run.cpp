#include "scene_io/assimp/trial_run.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <new>
#include <span>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/clock.h"
#include "relume/error.h"

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

/// Exit status of a child without memory.
constexpr int kOutOfMemory = 3;
constexpr int kThrew = 4;
constexpr int kNotHandedOver = 5;

/// Limits that the parent enforces, unlike those that waitpid() reports.
enum class Excess { none, memory, time };

struct ChildEnd {
  int status = 0;
  Excess excess = Excess::none;  ///< limit for which the parent killed the child
};

/// Memory of a process ("self" or its number), in bytes.
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

/// Pipe from the child to the parent. Unlike files in memory, it is exempt from limits on file sizes.
class Pipe {
 public:
  Pipe() {
    if (pipe2(ends_.data(), O_CLOEXEC) != 0)
      throw Error(
          fmt::format("no pipe can be opened ({}); close some files or raise the limit on them", std::strerror(errno)));
    fcntl(ends_[0], F_SETFL, O_NONBLOCK);
  }
  ~Pipe() {
    close_end(ends_[0]);
    close_end(ends_[1]);
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  void close_reader() { close_end(ends_[0]); }
  void close_writer() { close_end(ends_[1]); }

  bool write_all(std::span<const std::byte> bytes) const {
    while (!bytes.empty()) {
      const ssize_t written = write(ends_[1], bytes.data(), bytes.size());
      if (written < 0 && errno != EINTR) return false;
      if (written > 0) bytes = bytes.subspan(static_cast<size_t>(written));
    }
    return true;
  }

  /// Appends a block of received bytes. Returns false if none is available.
  bool receive(Bytes& bytes) {
    std::array<std::byte, size_t{1} << 16> block;
    ssize_t count = 0;
    do count = read(ends_[0], block.data(), block.size());
    while (count < 0 && errno == EINTR);
    if (count == 0) close_reader();
    if (count <= 0) return false;
    bytes.insert(bytes.end(), block.begin(), block.begin() + count);
    return true;
  }

  /// Waits until bytes arrive, at most `most_us`.
  void wait(long most_us) const {
    pollfd reader{ends_[0], POLLIN, 0};
    const timespec most{0, most_us * 1000};
    ppoll(&reader, 1, &most, nullptr);
  }

 private:
  static void close_end(int& end) {
    if (end >= 0) close(end);
    end = -1;
  }

  std::array<int, 2> ends_{-1, -1};  ///< read end and write end
};

void limit(__rlimit_resource resource, uint64_t soft, uint64_t hard) {
  const rlimit both{soft, hard};
  setrlimit(resource, &both);
}

/// Restores default handlers, so that the parent's crash reporters do not run in the child. Interrupts that the parent
/// ignores (as under `nohup`) stay ignored.
void reset_signals() {
  for (const int signal_number : {SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGXCPU})
    std::signal(signal_number, SIG_DFL);
  for (const int signal_number : {SIGINT, SIGTERM}) {
    if (std::signal(signal_number, SIG_DFL) == SIG_IGN) std::signal(signal_number, SIG_IGN);
  }
}

void silence_output() {
  const int null = open("/dev/null", O_WRONLY);
  if (null < 0) return;
  dup2(null, STDOUT_FILENO);
  dup2(null, STDERR_FILENO);
}

[[noreturn]] void run_child(const std::function<Bytes()>& task, const TrialLimits& limits, uint64_t address_space,
                            pid_t parent, Pipe& result) {
  constexpr uint64_t kGrace_s = 5;  // SIGXCPU comes first and distinguishes this limit from others
  reset_signals();
  prctl(PR_SET_PDEATHSIG, SIGKILL);        // ends the child if the parent is killed
  if (getppid() != parent) _exit(kThrew);  // it was killed before
  silence_output();
  result.close_reader();
  limit(RLIMIT_CORE, 0, 0);
  limit(RLIMIT_CPU, limits.cpu_s, limits.cpu_s + kGrace_s);
  if (kLimitAddressSpace) limit(RLIMIT_AS, address_space, address_space);
  // Exits directly: libraries that catch std::bad_alloc would report a damaged file.
  std::set_new_handler([] { _exit(kOutOfMemory); });
  try {
    if (!result.write_all(task())) _exit(kNotHandedOver);
  } catch (...) {
    _exit(kThrew);
  }
  _exit(0);
}

/// Appends received bytes to `result`. Kills the child if `result` cannot grow.
bool receive_from(pid_t child, Pipe& pipe, Bytes& result) {
  try {
    return pipe.receive(result);
  } catch (const std::bad_alloc&) {
    kill(child, SIGKILL);
    while (waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
    }
    throw;
  }
}

/// Receives the child's result until it ends. Kills it if it exceeds a limit that the kernel does not enforce.
ChildEnd wait_for(pid_t child, double wall_s, uint64_t resident_limit, Pipe& pipe, Bytes& result) {
  constexpr long kLongestPause_us = 10'000;
  const double deadline_s = now_s() + wall_s;
  long pause_us = 100;
  ChildEnd end;
  int options = WNOHANG;
  while (true) {
    const pid_t ended = waitpid(child, &end.status, options);
    if (ended == child) break;
    if (ended < 0 && errno != EINTR)
      throw Error("the process that reads the file ended without a status; start relume without ignoring SIGCHLD");
    if (end.excess == Excess::none) {
      if (pages_in_use(std::to_string(child)).resident > resident_limit) end.excess = Excess::memory;
      if (now_s() > deadline_s) end.excess = Excess::time;
    }
    if (end.excess != Excess::none) {
      kill(child, SIGKILL);
      options = 0;
    } else if (!receive_from(child, pipe, result)) {
      pipe.wait(pause_us);
      pause_us = std::min(2 * pause_us, kLongestPause_us);
    }
  }
  while (pipe.receive(result)) {
  }
  return end;
}

/// Sentence after "place: " for a child without a result; empty on success.
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
  if (exit_status == kNotHandedOver)
    return "the process that reads the file could not return its result; load the file again";
  if (exit_status != 0) return fmt::format("reading crashed (exit status {}); {}", exit_status, kRemedy);
  return {};
}

}  // namespace

Bytes run_trial(const std::function<Bytes()>& task, const TrialLimits& limits, const std::string& place) {
  const PagesInUse own = pages_in_use("self");
  Pipe pipe;
  const pid_t parent = getpid();
  const pid_t child = fork();
  if (child < 0)
    throw Error(fmt::format(
        "{}: no process can be started to read the file; free some memory or raise the limit on processes", place));
  if (child == 0) run_child(task, limits, own.address_space + limits.memory_bytes, parent, pipe);
  pipe.close_writer();
  Bytes result;
  const ChildEnd end = wait_for(child, limits.wall_s, own.resident + limits.memory_bytes, pipe, result);
  const std::string problem = problem_of(end, limits);
  if (!problem.empty()) throw Error(fmt::format("{}: {}", place, problem));
  return result;
}

}  // namespace relume
