// What only the operating system knows. Of the program, platform.cpp and child_pipe.cpp assume POSIX; of the library,
// core/memory.cpp, io/atomic_file.cpp, io/temporary_file.cpp, io/tev_client.cpp and io/assimp/trial_run.cpp.
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
/// Width of the terminal on standard error; 80 if it is not known.
int terminal_columns();

/// The most memory that the process has held so far.
uint64_t peak_memory_bytes();

/// "AMD EPYC 7B13"; "unknown" where the system does not tell.
std::string processor_name();

/// Differs from one build of the program to the next; empty where the system does not tell.
std::string program_stamp();

/// Whether a file could be created in the folder (empty: the current one).
bool folder_is_writable(const std::string& folder);

/// Whether an existing file may be written.
bool is_writable(const std::string& file);

/// Device and number of a file, the same for all names that it has; std::nullopt if there is none.
std::optional<std::pair<uint64_t, uint64_t>> file_number(const std::string& file);

/// Lets other threads go first: this one, and those that it starts from now on.
void lower_thread_priority();

/// Folder in which the program may keep what it remembers between runs ($XDG_STATE_HOME/relume, ~/.local/state/relume);
/// empty if there is no home. It need not exist.
std::string state_folder();

/// Folder for references: below `cache_folder` or, if that is empty, below $XDG_CACHE_HOME/relume or ~/.cache/relume.
/// It need not exist. Throws UsageError if the environment tells of neither.
std::string reference_folder(const std::string& cache_folder);

/// Sets how the process takes signals: SIGINT and SIGTERM end it at once with kExitInterrupted and leave no temporary
/// file; a limit of file size makes writing fail and kills nothing. Call it first.
void prepare_signals();

/// While it lives, the first SIGINT or SIGTERM requests a stop and the second ends the process at once with
/// kExitInterrupted. At most one at a time.
class InterruptGuard {
 public:
  /// `notice`: told on standard error at the first interrupt, unless it is empty.
  explicit InterruptGuard(std::string notice);
  ~InterruptGuard();
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

  std::stop_token token() const { return source_.get_token(); }

 private:
  std::string notice_;
  std::stop_source source_;
  std::thread waiter_;  ///< requests the stop, which a signal handler may not
};

}  // namespace relume::cli
