#include "io/assimp/trial_run.h"

#include <cerrno>
#include <csignal>
#include <fstream>

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/error.h"

namespace relume {
namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kLimitMemory = false;  // sanitizers reserve terabytes
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
constexpr bool kLimitMemory = false;
#else
constexpr bool kLimitMemory = true;
#endif
#else
constexpr bool kLimitMemory = true;
#endif

uint64_t address_space_in_use() {
  uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<uint64_t>(sysconf(_SC_PAGESIZE));
}

void limit(__rlimit_resource resource, uint64_t value) {
  const rlimit both{value, value};
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

[[noreturn]] void run_child(const std::function<void()>& task, uint64_t cpu_seconds, uint64_t address_space) {
  reset_signals();
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // a program that is ended meanwhile leaves nobody behind
  silence_output();
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, cpu_seconds);
  if (kLimitMemory) limit(RLIMIT_AS, address_space);
  try {
    task();
  } catch (...) {
    // The parent meets the same exception and reports it.
  }
  _exit(0);
}

}  // namespace

bool survives_trial(const std::function<void()>& task, uint64_t cpu_seconds, uint64_t memory_bytes) {
  const uint64_t address_space = address_space_in_use() + memory_bytes;
  const pid_t child = fork();
  if (child < 0)
    throw Error("no process can be started to check the file; free some memory or raise the limit on processes");
  if (child == 0) run_child(task, cpu_seconds, address_space);
  int status = 0;
  while (waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) throw Error("the process that checks the file ended unseen; start relume another way");
  }
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace relume
