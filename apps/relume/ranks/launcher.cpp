#include "ranks/launcher.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string_view>
#include <system_error>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include "relume/error.h"

namespace relume::ranks {
namespace {

/// Variable with the path of the plugin; empty: the process ignores its launcher.
constexpr const char* kPlugin = "RELUME_MPI_PLUGIN";

std::optional<int> number_in(const char* variable) {
  const char* const value = std::getenv(variable);
  if (!value) return std::nullopt;
  const std::string_view text(value);
  int number = 0;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (failure != std::errc{} || end != text.data() + text.size() || number < 0) return std::nullopt;
  return number;
}

const char* name_of(MpiLibrary library) { return library == MpiLibrary::open_mpi ? "openmpi" : "mpich"; }

std::vector<std::filesystem::path> plugin_files(MpiLibrary library) {
  if (const char* const file = std::getenv(kPlugin)) return {file};
  std::error_code failure;
  const std::filesystem::path folder = std::filesystem::read_symlink("/proc/self/exe", failure).parent_path();
  const std::string name = fmt::format("relume-mpi-{}.so", name_of(library));
  return {folder / name, folder.parent_path() / "lib" / "relume" / name};
}

std::string name_of_process(pid_t process) {
  std::ifstream stream(fmt::format("/proc/{}/comm", process));
  std::string name;
  std::getline(stream, name);
  return name;
}

/// Parent and start time of a process, as its file in /proc states them.
struct ProcessStatus {
  pid_t parent = 0;
  std::string start;
};
ProcessStatus status_of(pid_t process) {
  std::ifstream stream(fmt::format("/proc/{}/stat", process));
  std::string text;
  std::getline(stream, text);
  const size_t name_end = text.rfind(')');
  if (name_end == std::string::npos) return {};
  ProcessStatus status;
  size_t at = name_end + 1;
  for (int field = 3; field <= 22 && at != std::string::npos; ++field) {
    const size_t begin = text.find_first_not_of(' ', at);
    if (begin == std::string::npos) break;
    at = text.find(' ', begin);
    const std::string value = text.substr(begin, at - begin);
    if (field == 4) status.parent = static_cast<pid_t>(std::atoi(value.c_str()));
    if (field == 22) status.start = value;
  }
  return status;
}

/// mpirun above this process; 0: none. Daemons of the launcher may be between them.
pid_t find_launcher() {
  pid_t process = getppid();
  for (int i = 0; i < 3 && process > 1; ++i) {
    const std::string name = name_of_process(process);
    for (const std::string_view launcher : {"mpirun", "mpiexec", "orterun", "prterun"}) {
      if (name.starts_with(launcher)) return process;
    }
    if (!name.starts_with("hydra") && !name.starts_with("sh") && !name.starts_with("timeout")) return 0;
    process = status_of(process).parent;
  }
  return 0;
}

void pause_s(int seconds) {
  timespec time{seconds, 0};
  nanosleep(&time, nullptr);
}

}  // namespace

std::optional<Launch> find_launch() {
  // A program under a launcher passes its variables on to the commands that it runs.
  if (const char* const plugin = std::getenv(kPlugin); plugin && *plugin == '\0') return std::nullopt;
  const auto size = number_in("OMPI_COMM_WORLD_SIZE");
  if (size) {
    return Launch{MpiLibrary::open_mpi, number_in("OMPI_COMM_WORLD_RANK").value_or(0), *size,
                  number_in("OMPI_COMM_WORLD_LOCAL_SIZE").value_or(1)};
  }
  if (const auto ranks = number_in("PMI_SIZE")) {
    return Launch{MpiLibrary::mpich, number_in("PMI_RANK").value_or(0), *ranks,
                  number_in("MPI_LOCALNRANKS").value_or(1)};
  }
  // srun sets the number for every job step; only PMIX_RANK, from its --mpi, shows that the step may use MPI. Sites
  // have that as a default, so a step of one task says nothing.
  const auto tasks = number_in("SLURM_STEP_NUM_TASKS");
  if (std::getenv("PMIX_RANK") && tasks && *tasks > 1) {
    return Launch{MpiLibrary::open_mpi, number_in("PMIX_RANK").value_or(0), *tasks, 1};
  }
  return std::nullopt;
}

const RelumeMpi& load_mpi(MpiLibrary library) {
  std::string problem;
  for (const std::filesystem::path& file : plugin_files(library)) {
    std::error_code failure;
    if (!std::filesystem::exists(file, failure)) continue;
    void* const handle = ::dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle) {
      problem = ::dlerror();
      continue;
    }
    const auto function = reinterpret_cast<RelumeMpiFunction>(::dlsym(handle, kRelumeMpiFunction));
    if (function && function()->version == kRelumeMpiVersion) return *function();
    problem = fmt::format("{} belongs to another version of relume", file.string());
  }
  throw Error(fmt::format(
      "the launcher of {} started several ranks, but the plugin relume-mpi-{}.so cannot be loaded{}; build relume with "
      "RELUME_MPI where {} is installed, or start it without the launcher",
      library == MpiLibrary::open_mpi ? "Open MPI" : "MPICH", name_of(library),
      problem.empty() ? "" : " (" + problem + ")",
      library == MpiLibrary::open_mpi ? "libopenmpi-dev" : "libmpich-dev"));
}

int threads_of_rank(const Launch& launch) {
  const auto all = static_cast<int>(std::max(sysconf(_SC_NPROCESSORS_ONLN), 1L));
  cpu_set_t bound;
  CPU_ZERO(&bound);
  const int allowed = sched_getaffinity(0, sizeof(bound), &bound) == 0 ? CPU_COUNT(&bound) : all;
  if (allowed < all) return std::max(allowed, 1);
  return std::max(all / std::max(launch.local_size, 1), 1);
}

void end_launcher(int after_s) {
  const pid_t launcher = find_launcher();
  if (launcher == 0) return;
  const std::string file = fmt::format("/proc/{}/stat", launcher);
  const std::string start = " " + status_of(launcher).start + " ";
  if (fork() != 0) return;
  // Only functions that are safe after a fork of a process with threads.
  setsid();
  // Open connections would hide the end of this process from the launcher and other ranks.
  close_range(0, std::numeric_limits<unsigned>::max(), 0);
  for (const int signal_number : {SIGTERM, SIGTERM, SIGKILL}) {  // Open MPI ends at once at the second
    pause_s(signal_number == SIGKILL ? 3 : after_s);
    after_s = 3;
    std::array<char, 1024> text{};
    const int stat = open(file.c_str(), O_RDONLY | O_CLOEXEC);
    const ssize_t size = stat < 0 ? -1 : read(stat, text.data(), text.size() - 1);
    if (stat >= 0) close(stat);
    if (size <= 0 || std::string_view(text.data(), static_cast<size_t>(size)).find(start) == std::string_view::npos)
      break;
    kill(launcher, signal_number);
  }
  _exit(0);
}

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? std::string(name.data()) : "an unnamed host";
}

}  // namespace relume::ranks
