// Operating-system services. In the program, platform.cpp, child_pipe.cpp, serve/token.cpp and those of ranks/ assume
// POSIX; in the library, core/memory.cpp, files/atomic_file.cpp, files/temporary_file.cpp, image/tev_client.cpp and
// scene_io/assimp/trial_run.cpp.
#pragma once

#include <cstdint>
#include <cstdio>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>

namespace relume::cli {

bool is_terminal(std::FILE* stream);
/// Width of the terminal on standard error; 80 if unknown.
int terminal_columns();

/// Peak memory of the process so far, bytes.
uint64_t peak_memory_bytes();

/// "AMD EPYC 7B13"; "unknown" if the system does not report it.
std::string processor_name();

/// Differs between builds of the program; empty if unavailable.
std::string program_stamp();

/// Whether a file could be created in the folder (empty: the current one).
bool folder_is_writable(const std::string& folder);

/// Whether an existing file is writable.
bool is_writable(const std::string& file);

/// Device and number of a file, the same for all its names; std::nullopt if it does not exist.
std::optional<std::pair<uint64_t, uint64_t>> file_number(const std::string& file);

/// Lowers the priority of this thread and of the threads that it starts later.
void lower_thread_priority();

/// Folder for the program's state between runs ($XDG_STATE_HOME/relume, ~/.local/state/relume); empty without a home
/// folder. It need not exist.
std::string state_folder();

/// Folder for references: below `cache_folder` or, if that is empty, below $XDG_CACHE_HOME/relume or ~/.cache/relume.
/// It need not exist. Throws UsageError if the environment defines neither.
std::string reference_folder(const std::string& cache_folder);

/// Installs the signal handling; call it first. SIGINT and SIGTERM end the process at once with kExitInterrupted and
/// leave no temporary file, unless the process was started with them ignored. Exceeding a file-size limit fails the
/// write instead of killing the process.
void prepare_signals();

/// During its lifetime, the first SIGINT or SIGTERM requests a stop and the second ends the process at once with
/// kExitInterrupted. Ignored signals stay ignored. At most one may exist.
class InterruptGuard {
 public:
  /// `notice`: printed on standard error at the first interrupt, unless empty.
  explicit InterruptGuard(std::string notice);
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  std::stop_token token() const { return source_.get_token(); }

 private:
  std::string notice_;
  std::stop_source source_;
  std::thread waiter_;  ///< requests the stop, which is not allowed in a signal handler
};

}  // namespace relume::cli
