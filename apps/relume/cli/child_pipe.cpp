#include "cli/child_pipe.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include <fmt/format.h>

#include "relume/error.h"

extern char** environ;

namespace relume::cli {
namespace {

constexpr int kUnknownExit = 255;  // the exit status could not be determined

}  // namespace

ChildPipe::ChildPipe(const std::vector<std::string>& arguments) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0)
    throw Error("cannot open a pipe: too many open files; close other programs or raise the limit (ulimit -n)");
  std::vector<char*> argv;
  for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
  argv.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[0], STDIN_FILENO);
  // Only the parent handles interrupts; the child ends when its input does.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  const int failure = posix_spawnp(&child_, argv[0], &actions, &attributes, argv.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[0]);
  pipe_ = ends[1];
  if (failure == 0) return;
  close(pipe_);
  throw Error(fmt::format("{} cannot be started; install it, or check its permissions", arguments[0]));
}

ChildPipe::~ChildPipe() {
  if (child_ <= 0) return;
  kill(child_, SIGTERM);
  finish();
}

bool ChildPipe::write(const void* data, size_t bytes) {
  const auto* next = static_cast<const char*>(data);
  const auto handler = std::signal(SIGPIPE, SIG_IGN);
  while (bytes > 0) {
    const ssize_t written = ::write(pipe_, next, bytes);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) break;
    next += written;
    bytes -= static_cast<size_t>(written);
  }
  std::signal(SIGPIPE, handler);
  return bytes == 0;
}

int ChildPipe::finish() {
  close(pipe_);
  int status = 0;
  while (waitpid(child_, &status, 0) < 0) {
    if (errno == EINTR) continue;
    child_ = -1;
    return kUnknownExit;
  }
  child_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

bool program_exists(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path ? path : "");
  for (std::string folder; std::getline(folders, folder, ':');) {
    const std::filesystem::path file = std::filesystem::path(folder) / name;
    std::error_code failure;
    if (access(file.c_str(), X_OK) == 0 && std::filesystem::is_regular_file(file, failure)) return true;
  }
  return false;
}

}  // namespace relume::cli
