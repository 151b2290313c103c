#include "cli/platform.h"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <utility>

#include "cli/command.h"
#include "files/temporary_file.h"

namespace relume::cli {
namespace {

// The handler only uses a lock-free counter and a pipe. They are global because a handler takes no user argument.
std::atomic<int> g_interrupts{0};
int g_pipe[2] = {-1, -1};
struct sigaction g_previous_int;
struct sigaction g_previous_term;

void write_byte(char byte) {
  if (write(g_pipe[1], &byte, 1) < 0) _exit(kExitInterrupted);
}

extern "C" void relume_end(int) {
  remove_temporary_files();
  _exit(kExitInterrupted);
}

extern "C" void relume_on_interrupt(int signal_number) {
  if (g_interrupts.fetch_add(1) > 0) relume_end(signal_number);
  write_byte('i');
}

/// Handles the signal by relume_on_interrupt(), unless it is ignored. `previous` receives its present action.
void handle_interrupt(int number, struct sigaction& previous) {
  sigaction(number, nullptr, &previous);
  if (previous.sa_handler == SIG_IGN) return;  // ignored by `nohup` or a shell's background job
  struct sigaction action {};
  action.sa_handler = relume_on_interrupt;
  action.sa_flags = SA_RESTART;
  sigaction(number, &action, nullptr);
}

/// The program's folder below the one named by an environment variable, else below the home folder; empty without a
/// home folder.
std::string folder_of_user(const char* variable, const char* below_home) {
  const auto value_of = [](const char* name) {
    const char* value = std::getenv(name);
    return std::string(value ? value : "");
  };
  if (const std::string folder = value_of(variable); !folder.empty()) return folder + "/relume";
  const std::string home = value_of("HOME");
  return home.empty() ? "" : home + "/" + below_home + "/relume";
}

}  // namespace

bool is_terminal(std::FILE* stream) { return isatty(fileno(stream)) == 1; }

int terminal_columns() {
  winsize size{};
  const bool known = ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
  return known ? size.ws_col : 80;
}

uint64_t peak_memory_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<uint64_t>(usage.ru_maxrss) * 1024;  // Linux reports kibibytes
}

std::string program_stamp() {
  struct stat info {};
  if (stat("/proc/self/exe", &info) != 0) return {};
  return std::to_string(info.st_size) + "-" + std::to_string(info.st_mtim.tv_sec) + "-" +
         std::to_string(info.st_mtim.tv_nsec);
}

std::string processor_name() {
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);) {
    const size_t colon = line.find(": ");
    if (line.starts_with("model name") && colon != std::string::npos) return line.substr(colon + 2);
  }
  return "unknown";
}

void lower_thread_priority() {
  constexpr int kNice = 10;
  // Linux keeps the priority per thread, and threads inherit it. Failure only costs smoothness.
  setpriority(PRIO_PROCESS, static_cast<id_t>(syscall(SYS_gettid)), kNice);
}

std::string state_folder() { return folder_of_user("XDG_STATE_HOME", ".local/state"); }

std::string reference_folder(const std::string& cache_folder) {
  const std::string folder = cache_folder.empty() ? folder_of_user("XDG_CACHE_HOME", ".cache") : cache_folder;
  if (folder.empty())
    throw UsageError("neither XDG_CACHE_HOME nor HOME is set; use --cache-dir to choose a folder for references");
  return folder + "/references";
}

bool folder_is_writable(const std::string& folder) {
  return access(folder.empty() ? "." : folder.c_str(), W_OK | X_OK) == 0;
}

bool is_writable(const std::string& file) { return access(file.c_str(), W_OK) == 0; }

std::optional<std::pair<uint64_t, uint64_t>> file_number(const std::string& file) {
  struct stat info {};
  if (stat(file.c_str(), &info) != 0) return std::nullopt;
  return std::pair<uint64_t, uint64_t>(info.st_dev, info.st_ino);
}

void prepare_signals() {
  std::signal(SIGCHLD, SIG_DFL);  // some daemons ignore it; inherited, that would hide the children's exit status
  std::signal(SIGXFSZ, SIG_IGN);  // exceeding a file-size limit then fails like a full disk
  for (const int number : {SIGINT, SIGTERM}) {
    struct sigaction action {};
    sigaction(number, nullptr, &action);
    if (action.sa_handler != SIG_DFL) continue;  // ignored by `nohup` or a shell's background job
    action.sa_handler = relume_end;
    action.sa_flags = SA_RESTART;
    sigaction(number, &action, nullptr);
  }
}

InterruptGuard::InterruptGuard(std::string notice) : notice_(std::move(notice)) {
  if (pipe2(g_pipe, O_CLOEXEC) != 0)
    throw Error(
        "cannot open a pipe for signals: too many open files; close other programs or raise the limit (ulimit -n)");
  g_interrupts = 0;
  waiter_ = std::thread([this] {
    char byte = 0;
    while (read(g_pipe[0], &byte, 1) < 0) {  // interrupted by another signal
    }
    if (byte != 'i') return;
    if (!notice_.empty())  // below a progress bar
      std::fputs(((is_terminal(stderr) ? "\n" : "") + notice_ + "\n").c_str(), stderr);
    source_.request_stop();
  });
  handle_interrupt(SIGINT, g_previous_int);
  handle_interrupt(SIGTERM, g_previous_term);
}

InterruptGuard::~InterruptGuard() {
  sigaction(SIGINT, &g_previous_int, nullptr);
  sigaction(SIGTERM, &g_previous_term, nullptr);
  write_byte('q');
  waiter_.join();
  close(g_pipe[0]);
  close(g_pipe[1]);
}

}  // namespace relume::cli
